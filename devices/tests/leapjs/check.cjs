// Connects leapjs, the tracker maker's own client, to the port given, takes in frames and says what it saw, as one line of
// JSON. Usage: node check.cjs PORT FRAMES
const Leap = require("leapjs");

const [port, wanted] = process.argv.slice(2).map(Number);
const seen = { frames: 0, hands: 0, fingers: 0, bones: 0, types: {}, both: 0, devices: 0, version: null, faults: [] };
let lastId = -1;

const fault = (text) => {
  if (seen.faults.length < 10) seen.faults.push(text);
};
const finite = (v, length) => v && v.length === length && Array.from(v).every(Number.isFinite);
const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

function look(frame) {
  if (!frame.valid) fault(`frame ${frame.id} is not valid`);
  if (!(frame.id > lastId)) fault(`frame ${frame.id} after ${lastId}`);
  lastId = frame.id;
  seen.frames += 1;
  seen.both += frame.hands.length === 2 ? 1 : 0;
  for (const hand of frame.hands) {
    seen.hands += 1;
    seen.types[hand.type] = (seen.types[hand.type] || 0) + 1;
    if (!finite(hand.palmPosition, 3) || !finite(hand.direction, 3) || !finite(hand.palmNormal, 3)) fault("palm");
    if (hand.fingers.length !== 5) fault(`${hand.fingers.length} fingers`);
    if (hand.indexFinger !== hand.fingers[1] || !hand.thumb) fault("fingers are not named");
    if (!Number.isFinite(hand.roll()) || !Number.isFinite(hand.grabStrength)) fault("roll or grab");
    if (distance(hand.arm.prevJoint, hand.arm.nextJoint) < 200) fault("no arm");
    for (const finger of hand.fingers) {
      seen.fingers += 1;
      finger.bones.forEach((bone, i) => {
        seen.bones += 1;
        if (!finite(bone.prevJoint, 3) || !finite(bone.nextJoint, 3) || !finite(bone.center(), 3)) fault("bone");
        // A thumb has no metacarpal.
        if (!(finger.type === 0 && i === 0) && !(bone.length > 10 && bone.length < 90)) fault(`bone of ${bone.length} mm`);
        if (!finite(bone.matrix(), 16)) fault("bone matrix");
      });
      if (distance(finger.tipPosition, finger.distal.nextJoint) > 0.01) fault("the tip is not the last bone's end");
    }
  }
  if (!finite(frame.interactionBox.normalizePoint([0, 200, 0], true), 3)) fault("interaction box");
}

const controller = new Leap.Controller({ host: "127.0.0.1", port, background: true });
controller.on("ready", () => (seen.version = controller.connection.protocol.version));
controller.on("streamingStarted", () => (seen.devices += 1));
controller.on("frame", (frame) => {
  try {
    look(frame);
  } catch (e) {
    fault(String(e));
  }
  if (seen.frames >= wanted) {
    console.log(JSON.stringify(seen));
    process.exit(0);
  }
});
setTimeout(() => {
  console.log(JSON.stringify({ ...seen, faults: [...seen.faults, "timed out"] }));
  process.exit(1);
}, 30000);
controller.connect();
