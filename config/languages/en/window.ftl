# What the window says in English: the language that every other one falls back to.
# A line is a message: its id, its text, and below it, indented, its tooltip or its explanation.
# What stands in braces is put in by the program and must occur in every language.

language-name = English
    .latin = English

## Keys that are held with another one

key-ctrl = Ctrl
key-alt = Alt
key-shift = Shift

## Words that many places share

off = off
none = none
cancel = Cancel
reset = Reset
undo = Undo
redo = Redo
open = Open
export = Export
length-mm = { $value } mm
area-mm2 = { $value } mm²
volume-mm3 = { $value } mm³
time-ms = { $value } ms
percent = { $value } %
size-bytes = { $value } B
size-kilobytes = { $value } kB
size-megabytes = { $value } MB
triangles = { $count } triangles
both-keys = { $first } and { $second }
name-with-keys = { $name } ({ $keys })

## Pages at the right

page-look = Look
    .about = How the clay is shown
page-scene = Scene
    .about = A second object, Booleans, levels of detail, trimming
page-walls = Walls
    .about = Wall thickness and thin spots
page-measure = Size
    .about = Measures, the shadow along a direction, distances to another form
page-files = Files
    .about = Open, export, pictures
page-devices = Pens
    .about = Devices and their live values
page-loop = Loop
    .about = Timing of the tick loop and of this window
page-more = More
    .about = Language, preferences and messages

## Brushes

kind-gaussian = Gaussian
    .about = Raises a bell of clay along the surface normal (Cipollini 2020).
kind-smooth = Smooth
    .about = Evens the surface: the cotangent-weighted Laplacian, strength being the share of the way in one dab.
kind-draw = Draw
    .about = Raises the surface along its mean normal, by the falloff.
kind-clay = Clay
    .about = Builds clay up in a flat coat: fills to a plane a little over the surface.
kind-clay-strips = Clay strips
    .about = Lays clay on in bands with flat tops and square ends, turned along the stroke.
kind-inflate = Inflate
    .about = Swells the form: every vertex along its own normal.
kind-layer = Layer
    .about = One coat of even height a stroke, however often the stroke passes over it.
kind-crease = Crease
    .about = Cuts a groove whose sides are drawn together; negative raises a ridge.
kind-pinch = Pinch
    .about = Draws the surface together to the middle of the brush; negative spreads it.
kind-blob = Blob
    .about = Raises a round drop: the surface swells away from a point below it.
kind-flatten = Flatten
    .about = Draws hills and hollows to the mean plane; negative deepens them.
kind-fill = Fill
    .about = Fills hollows up to the mean plane and leaves hills; negative takes the hills down.
kind-scrape = Scrape
    .about = Takes hills down to the mean plane and leaves hollows; negative fills the hollows.
kind-trim = Trim
    .about = Cuts off what stands over a plane set a little below the surface, as a knife does.
kind-grab = Grab
    .about = What was under the brush when the pen came down follows the pen.
kind-elastic = Elastic
    .about = Moves the clay as an elastic body held at a point (regularised Kelvinlets, de Goes and James 2017).
kind-topological = Topological
    .about = As grab, but what is held is what is near along the surface, not through the air.
kind-snake-hook = Snake hook
    .about = Draws clay out after the pen, and goes with it.
kind-twist = Twist
    .about = Turns what was under the brush about the surface normal as the pen goes to the right.
kind-thumb = Thumb
    .about = Smears what was under the brush along the surface.
kind-nudge = Nudge
    .about = Pushes the surface along with the stroke.
kind-relax = Relax
    .about = Evens the triangles along the surface and leaves the form.
kind-mask = Mask
    .about = Protects what it paints from other brushes; negative frees it.
kind-mask-blur = Mask blur
    .about = Softens the edges of the mask; negative sharpens them.
kind-paint = Paint
    .about = Lays the colour of the brush on the clay.
kind-texture = Texture
    .about = Presses an alpha along the stroke as relief, bent as the stroke is, repeating along it.
kind-density = Density
    .about = Brings the triangles under it to the wanted size, a share of the brush, and evens them; the form stays.
kind-simplify = Simplify
    .about = Draws small triangles together to the wanted size, a share of the brush; large ones and the form stay.
kind-slide-relax = Slide relax
    .about = Slides the triangles along the surface with the stroke and leaves the form; with Shift, or turned round, relaxes them.
kind-plane = Plane
    .about = Brings hills and hollows to the mean plane of the surface as the stroke found it; negative deepens them.
kind-multiplane-scrape = Multiplane scrape
    .about = Scrapes two planes that meet along the stroke, so that a ridge with flat sides is left.
kind-sharpen = Sharpen
    .about = Makes fine relief stand out; negative takes it down.
kind-surface-smooth = Surface smooth
    .about = Evens the surface and keeps its volume (Taubin 1995).
kind-boundary = Boundary
    .about = The border of an open surface follows the pen, and the surface behind it.
kind-erase-layer = Erase layer
    .about = Takes away what the active layer does; the surface goes back to what is below it.
kind-draw-face-sets = Draw face sets
    .about = Draws face sets: each stroke a new one; negative goes on with the set that it began on.

## Numbers of single brushes

number-depth = depth
    .blob = how far below the surface that point lies, in radii
    .plane = how far below the plane the slab reaches, in radii
    .trim = how far below the surface it cuts, in radii, at full strength
number-lift = lift
    .about = how far over the surface the plane stands, in radii, at full strength
number-fill = fill
    .about = the share of the way to the plane over a fifth of the radius travelled
number-roundness = roundness
    .about = 0 a square, 1 a disc
number-pinch = pinch
    .about = how much the sides are drawn together
number-poisson = poisson
    .about = how far the clay keeps its volume: 0.5 wholly
number-offset = offset
    .about = how far the plane is moved along its normal, in radii
number-angle = angle
    .about = between the planes' normals, in degrees
number-height = height
    .about = how far over the plane the slab reaches, in radii
number-scale = scale
    .about = length of one repeat, in widths of the brush
number-floor = floor
    .about = the height of the alpha that stays on the surface; what is lower is pressed in
number-width = width
    .about = width of the alpha in brush widths: below 1 it repeats, above 1 it is cropped
number-set = set
    .about = the number of the face set that is drawn; 0: each stroke begins a new one

## The brush's settings

brush-more = More brushes
brush-now = Brush: { $name }
brush-favourites = Favourites
brush-favourite = Favourite
    .tip = Stands first among the brushes
brush-own = Your own
    .tip = { $what } (once more: as it was saved)
brush-own-about = { $kind }: { $about }
brush-radius = Radius
    .tip = At full pressure ({ $keys }, or { $drag } and drag)
brush-radius-pixels = Radius in pixels
    .tip = The brush keeps its size on the screen while the view is zoomed; off: its size on the object
brush-strength = Strength
    .tip = How much one dab does ({ $keys }, or { $drag } and drag)
brush-carve = Carve
    .tip = { $action }; hold Ctrl for one stroke
brush-stroke = Stroke
brush-settings = More settings
brush-dab = Shape of a dab
brush-stamp = Alpha and stamp
brush-automasks = Automatic masks
brush-topology = Dynamic topology
brush-save = Save this brush
    .tip = It stands among your own, with all its settings and its picture
brush-save-name = Name
brush-save-new = Save
brush-save-replace = Replace
brush-save-wrong = Up to 64 letters, digits, spaces, - and _, and no name of a brush of the program

stroke-spacing = Spacing
    .tip = Distance between dabs as a share of the radius
stroke-stabilizer = Stabilizer
    .tip = The brush follows the pen at this distance: a share of the view's height
stroke-steadiness = Steadiness
    .tip = Length of the string by which the brush follows the pen, in radii
stroke-average = Averaged reports
    .tip = The brush goes to the mean of so many reports of the pen
stroke-jitter = Jitter
    .tip = How far dabs are scattered about the path, in radii
stroke-seed = Seed of the jitter:
stroke-method = Method
stroke-continuous = Go on while the pen rests
stroke-ticks = Ticks between dabs at rest
stroke-compensate = Same strength at any spacing
    .tip = Strength counts over the way of the pen; off: each dab has all of it
stroke-accumulate = Accumulate
    .tip = A stroke builds upon what it has raised itself
stroke-limit = Limit of a stroke
    .tip = How far a stroke may move a point, in heights of one full dab; 0: no limit

method-space = Evenly spaced
method-dots = Dots
method-airbrush = Airbrush
method-anchored = Anchored
method-drag-dot = Dragged dot
method-line = Line
method-curve = Curve by points

dab-falloff = Falloff
dab-curve-tip = At { $eighths } eighths of the radius
dab-hardness = Hardness
    .tip = Share of the radius within which the brush works in full
dab-smoothing = Smoothing
    .tip = Each dab is smoothed at this strength
dab-averaging = Averaging
    .tip = Share of the radius over which the plane of the surface is averaged
dab-plane-trim = Plane trim
    .tip = Leaves surface further from the plane than this unchanged, in radii; 0: no limit
dab-tilt = Tilt
    .tip = How much a dab leans as the pen does
dab-colour = Colour

colour-sample = Pick
    .tip = { $action }: the next click on the clay takes its colour
colour-sample-here = Click the colour on the clay
colour-keep = Keep
    .tip = The colour stands below from now on
colour-swatch = Colour { $code }
    .tip = { $code }: a click takes it, the right button removes it
colour-nothing = There is no clay under the pointer

falloff-gaussian = Gaussian
falloff-smooth = Smooth
falloff-sphere = Sphere
falloff-root = Root
falloff-sharp = Sharp
falloff-linear = Linear
falloff-constant = Constant
falloff-custom = Custom

stamp-alpha = Alpha
stamp-stamp = Stamp
stamp-size = Stamp size
stamp-angle = Stamp angle
stamp-repeat = Repeat the stamp
stamp-right = Stencil right
stamp-up = Stencil up
stamp-at-tip = From the middle of the view, in its heights
stamp-off = None
stamp-dab = Under each dab
stamp-view = Along the view
stamp-stencil = Stencil

alpha-studs = Studs
alpha-scales = Scales
alpha-rope = Rope
alpha-stitches = Stitches
alpha-waves = Waves
alpha-bricks = Bricks
alpha-stone = Stone
alpha-cracks = Cracks
alpha-picture = Loaded picture

automask-front = Front faces only
automask-topology = Only connected parts
automask-sets = Only the face set of the first dab
automask-boundary = Borders stay
    .tip = The border of an open surface does not move
automask-normal = Normal limit
    .tip = Works only where the surface turns from the dab's normal by at most this angle, in degrees; 0: everywhere
automask-cavity = Cavity
    .tip = Above 0 only hollows are touched, below 0 only ridges

topology-by = Length of edges
topology-length = Length
topology-split = Split longer edges
topology-collapse = Collapse shorter edges
topology-off = Off
topology-brush = Share of the brush
topology-object = Share of the object
topology-view = Share of the view

## Mirror, pressure, masks, history

mirror-heading = Mirror

pressure-heading = Pressure
pressure-curve = Pressure curve
    .tip = Drag the left end for the lightest touch, the middle for the bend
pressure-lightest = Lightest
pressure-bend = Bend
pressure-radius = Radius
    .tip = Share of the radius at the lightest touch
pressure-radius-curve = Pressure curve of the radius
pressure-radius-bend = Radius bend

mask-heading = Mask
mask-clear = Clear
    .tip = Everything is free
mask-fill = Fill
    .tip = Masks everything
mask-invert = Invert
    .tip = Masks the unmasked vertices and unmasks the masked ones
mask-blur = Blur
    .tip = A softer border
mask-sharpen = Sharpen
    .tip = A harder border
mask-grow = Grow
    .tip = One ring of vertices more
mask-shrink = Shrink
    .tip = One ring less
mask-cavity = Hollows
    .tip = Masks the hollows
mask-thin = Thin places
    .tip = Masks everything at most this thick
mask-occlusion = Sheltered
    .tip = Masks everything that the object shades from the light
mask-thin-below = thin is
    .tip = Share of the longest side
mask-note = { $keys } shows it; the brush mask paints it

history-heading = History
history-steps = { $at } of { $all }
history-versions = { $count ->
    [one] { $count } version
   *[other] { $count } versions
}
history-step = Step
    .tip = Drag to go through the steps
history-after = After step { $step }
history-version = Version
    .tip = Drag to go through the versions of this line
history-row = Version { $node }, at { $time }
history-row-branch = Version { $node }, at { $time }, on a branch
history-replaced = replaced
history-added = added
history-removed = removed
history-duplicated = duplicated
history-renamed = renamed
history-moved = moved
history-activated = activated
history-shown = shown or hidden
history-locked = locked or unlocked
history-reshaped = reshaped
history-boolean = Boolean
history-merged = merged
history-split = split
history-layers = layers
history-sets = face sets
history-mask = mask
history-remesh = triangle size
history-snapped = laid flush
history-arranged = listed elsewhere
history-set-named = face set named
history-followed = followed its operands
history-applied = Boolean applied
history-mirrored = mirrored

## Page: look

look-material = Material
material-clay = clay
material-porcelain = porcelain
material-wax = wax
material-stone = stone
material-jade = jade
material-bronze = bronze
material-graphite = graphite
material-steel = steel
light-name = Light
    .tip = Pictures of surroundings (HDR, EXR) and of lit balls, square, are kept when they are dropped on the window
light-studio = Studio
light-room = Room
light-matcap = Lit ball
light-turned = Turned
light-raised = Height
light-shadow = Shadows
    .tip = { $action }: objects cast shadows in the main light
light-bright = Bright
reference-name = Reference
    .tip = Drop a picture that is not square on the window
reference-none = None
reference-behind = Behind the clay
reference-opacity = Dense
look-facets = Facets
look-cavity = Cavity
    .tip = Hollows darker, ridges lighter
look-occlusion = Occlusion
    .tip = { $action }: ambient occlusion in screen space
look-wireframe = Wireframe
look-grid = Grid
look-smooth-edges = Smooth edges
    .tip = Four samples a pixel; costs time where no graphics card draws
look-map = Map
map-none = None
    .tip = The clay itself
map-mask = Mask
map-thickness = Thickness
map-distance = Distance
look-camera = Camera
look-orthographic = Orthographic
look-angle = Angle
    .tip = Field of view, degrees
look-four-views = Four views
view-top = From above
view-free = Free
view-front = From the front
view-right = From the right
view-alone = Shows this view alone, as a double click beside the clay does. { $action } goes there and back.
views-no-copies = Four views need a screen that pictures can be copied to, which this driver does not offer. Work goes on in one view.
look-keep = Keep view
    .tip = Keeps this view under a number, to come back to
    .show = Shows this view again; a right click forgets it
legend-measuring = measuring

## Page: scene

scene-object = Object
scene-size = { $x } x { $y } x { $z } { $unit }
scene-held = Held object
    .tip = Appears beside the object, to be moved into it
scene-held-note = Take up a shape, move it into place, then add, cut or intersect.
scene-add = Add
    .tip = The two become one
scene-cut = Cut
    .tip = Cuts the held object out of the active one
scene-keep = Intersect
    .tip = Keeps only the volume that both share
scene-put-down = Put down
    .tip = It becomes an object where it is
scene-put-away = Put away
scene-busy = computing in the background: go on sculpting
scene-preview = Preview
scene-computing = computing ...
scene-shown = { $count } triangles of the held object
scene-apply = Apply
    .tip = Do what is shown
scene-dismiss = Dismiss
    .tip = The object stays as it is; the held one too
scene-yaw = yaw
scene-pitch = pitch
scene-roll = roll
scene-scale = scale
scene-held-size = size

objects-heading = Objects
objects-add = Add object
objects-duplicate = Duplicate
objects-rename = Rename
objects-remove = Remove
objects-locked = Locked: no stroke, no move, no removal
objects-group = Group
    .tip = Names the group that the object is listed in; an empty name ends it
objects-mirror = Mirror
objects-live = Booleans follow
    .tip = The operands stay, hidden, and the result is computed again when one of them is moved or changed
objects-follows = Follows its operands
objects-apply = Apply
    .tip = The operands go and the result stays as it is
objects-gizmo = Gizmo
    .tip = Move, turn and scale the object by the pointer; with Ctrl in steps
objects-snap = Snap face to face
    .tip = Lays a flat face of one object flush on one of another
objects-snap-first = Press on the face to move
objects-snap-second = Press on the face to lay it on
objects-eye = eye
    .tip = Drawn
objects-lock = lock
    .tip = Protected from strokes, moves and removal
objects-reset-place = Reset place
    .tip = Back to where it was made
shape-box = Box
shape-ball = Ball
shape-cylinder = Cylinder
shape-cone = Cone
shape-torus = Torus
shape-tube = Tube
shape-plane = Plane
operation-all = All four
    .tip = Union, intersection and both differences, each an object
operation-union = Union
    .tip = The active object and this one become one
operation-intersection = Intersection
    .tip = Keeps only the volume that both share
operation-difference = Difference
    .tip = This object is cut out of the active one
operation-reverse-difference = Reverse difference
    .tip = The active one is cut out of this one

sets-heading = Face sets
sets-eye-tip = Show or hide the face set
sets-colours = Show by colours
sets-isolate = only
    .tip = Hides all but this face set
sets-draw = draw
    .tip = Takes the brush that draws face sets, for this one
sets-none = in no set: { $count }
sets-row = set { $number }: { $count }
sets-hide-masked = Hide masked
    .tip = Hides what is masked by half or more
sets-invert = Invert visible
    .tip = Hides what is shown, and shows what is hidden
sets-show-all = Show all
    .tip = Nothing is hidden any more
sets-clear = Clear sets
    .tip = No vertex is in a face set any more; what is hidden stays hidden
sets-from-mask = From mask
    .tip = Makes a face set of all vertices masked by half or more
sets-from-visible = From visible
    .tip = All that is shown becomes a face set
sets-loose = Loose parts
    .tip = Each part that hangs together becomes a face set
sets-normals = By direction
    .tip = Each part that faces about one way becomes a face set
sets-crease = By creases
    .tip = Face sets meet where the surface bends by more than the angle
sets-degrees = Angle
sets-thickness = Thickness
    .tip = Share of the longest side; below 0 inwards
sets-extract-mask = Extract mask
    .tip = Extracts the masked part as a new object, a closed shell of this thickness
sets-extract-name = extract

layers-heading = Layers
layers-add = Add layer
    .tip = Strokes go to the new layer
layers-name = layer { $number }
layers-base = base
    .tip = Strokes lie below all layers
layers-unseen = The active layer is hidden or its intensity is 0: strokes would not be seen
layers-topology = Dynamic topology rests while the object has layers; bake them to use it
layers-eye = eye
    .tip = Seen
layers-up = Up
    .tip = Above the next layer
layers-down = Down
    .tip = Below the next layer
layers-merge = Merge down
    .tip = Adds it to the layer below, or to the base. Both must be seen
layers-duplicate = Duplicate layer
    .tip = A hidden twin above it
layers-clear = Clear layer
    .tip = Takes away what it does
layers-remove = Remove layer
    .tip = Removes it with what it does
layers-rename = Rename layer
layers-bake = Bake layers
    .tip = The surface as it is becomes the base

levels-heading = Levels
levels-at = level { $at } of { $all }, { $count } triangles
levels-coarser = Coarser
    .tip = Shape the whole; the detail of finer levels goes along
levels-finer = Finer
    .tip = Four triangles for each
    .back = Back to the finer level

remesh-heading = Remesh
remesh-own = Custom voxel size
    .tip = Otherwise the new triangles are about as large as the current ones
remesh-voxel = voxel
remesh-along = { $count } along the longest side
remesh-sharp = Keep sharp edges
remesh-button = Remesh
    .tip = One surface of even triangles; overlapping parts become one. { $keys }
remesh-local-heading = In place
remesh-local-edge = Edge length
    .tip = Times the usual edge length of the object
remesh-local-undo = { $keys } takes it back at any time, also while it is under way.
remesh-stretched = Refine what was stretched
    .tip = Splits edges that are too long, in the whole object; what is masked or hidden stays

quads-heading = Quads
quads-count = quads
quads-levels = finer levels
    .tip = The quads are the lowest level; finer levels bring the detail back
quads-button = Remesh with quads
    .tip = Quads that follow the shape; an export without levels writes them

decimate-heading = Decimate
decimate-share = of the triangles
decimate-button = Decimate
    .tip = Fewer triangles, for printing and the web. Nothing new crosses itself, and the border of the mask stays

trim-heading = Trim
trim-box = Box
    .tip = Drag a box over the view to cut off everything in it, all the way through
trim-line = Line
    .tip = Drag a line over the view: what lies to its left is cut off
trim-note = Drag over the view; Esc cancels.

region-heading = Region over the view
region-draw = Region:
region-lasso = Lasso
    .tip = Drag around what is meant
region-box = Box
    .tip = Drag from corner to corner
region-line = Line
    .tip = Drag a line: what lies to its left is meant
region-polyline = Polyline
    .tip = Press corner by corner
region-front = Front faces only
    .tip = Only what faces you; else all the way through
region-mask = Mask
    .tip = Protects what is in the region; with Ctrl: frees it
region-unmask = Unmask
    .tip = Frees what is in the region; with Ctrl: protects it
region-hide = Hide
    .tip = Hides what is in the region; with Ctrl: all but it
region-isolate = Show only
    .tip = Hides all but what is in the region; with Ctrl: what is in it
region-face-set = Face set
    .tip = Makes a new face set of everything in the region
region-remesh = Triangle size
    .tip = Triangles in the region get this edge length, all the way through
region-done = Done
    .tip = Ends drawing regions (Esc)
region-note = Drag over the view; with Ctrl the other way round. Esc ends.
region-polyline-note = Press each corner; the first or last once more, or Enter, closes it.

menu-add = add
menu-carve = carve
menu-keep = keep common
menu-put-away = put away
menu-ball = ball
menu-box = box
menu-cylinder = cylinder
menu-undo = undo
menu-redo = redo
menu-pick-up = pick up

## Page: walls

walls-heading = Wall thickness
walls-live = Live map
walls-process = Process
walls-own-limit = own limit
walls-too-thin-below = Too thin below
walls-note = Press { $keys }: the map follows the clay while you sculpt.
walls-thinnest = thinnest
walls-median = median
walls-thickest = thickest
walls-too-thin = too thin
walls-measured = measured
walls-spots = Thin spots
walls-none = None below the limit.
walls-spot = { $number }: { $value } mm
    .tip = The camera flies there
walls-histogram = Thickness histogram
    .tip = { $min } to { $max } mm; the line is the limit
process-abs = Injection moulding, ABS
process-fdm = Fused filament (FDM)
process-pa = Injection moulding, Polyamide (PA)
process-pc = Injection moulding, Polycarbonate (PC)
process-pom = Injection moulding, Acetal (POM)
process-pp = Injection moulding, Polypropylene (PP)
process-sla = Stereolithography (SLA)
process-sls = Laser sintering (SLS)

## Page: size

measure-heading = Measures
measure-waits = Measured when nothing changes.
measure-volume = volume
measure-area = area
measure-size = size { $axis }
measure-shadow = shadow { $axis }
measure-stale = Of an earlier state; measured again when nothing changes.
shadow-heading = Shadow
shadow-along = shadow along { $axis }
    .tip = Looked along { $axis }
shadow-here = From here
    .tip = Looked along as the camera does
shadow-size = { $x } x { $y } mm, { $holes } holes
shadow-file = Drawing to write
    .tip = The drawing's file
shadow-write = SVG
    .tip = The outline as a drawing to scale, millimetres
shadow-outline = Outline of the shadow
distance-heading = Distance
distance-live = Live distance map
distance-before = to before
    .tip = To the object as it was opened
distance-held = to the held object
distance-now = Compare with now
    .tip = Distances are measured to the object as it is now
distance-note = Blue lies within, red outside.
distance-deepest = deepest
distance-highest = highest
distance-rms = rms
distance-known = known

## Page: files

files-open = Open
    .note = Drop a mesh on the window, or:
files-open-name = File to open
files-browse = Browse...
files-recent = Recent
files-earlier = Earlier sculptures
files-export = Export
files-export-name = File to write
files-scale = Scale
files-unit = Unit
unit-pixel = px
unit-mm = mm
unit-cm = cm
unit-m = m
unit-inch = inch
files-save-as = Save as...
files-pictures = Pictures
files-screenshot = Screenshot
files-turntable = Turntable
files-frames = frames
files-replace = Replace
    .question = { $path } exists. Replace it?

chooser-open = Open a mesh
chooser-export = Export the sculpture
chooser-meshes = Meshes
chooser-home = Home
chooser-documents = Documents
chooser-downloads = Downloads
chooser-desktop = Desktop
chooser-up = Up
chooser-reading = reading...
chooser-empty = no folders and no mesh files here
chooser-name = Name

start-heading = Go on with
start-note = This new sculpture is saved as you work.
start-stay = Stay here
start-session = { $object }, { $date } { $time }

## Page: pens

devices-heading = Devices
devices-none = No tablet found: plug one in, nothing to restart.
    .mouse = The mouse sculpts too: slow strokes press harder.
devices-camera = Camera
    .privacy = Pictures stay in this program and are not stored.
devices-in-range = In range now
devices-pointer = pointer
devices-tablet = tablet { $number }
devices-serial = serial pen { $number }
devices-recording = recording { $number }
devices-demo = demo pen { $number }
devices-pen = pen { $number }
devices-eraser = { $pen }, eraser
devices-no-tilt = no tilt
devices-tilt = tilt { $x }, { $y } degrees
devices-pressure = pressure { $pressure }, { $tilt }
devices-place = at { $x } %, { $y } % of the view
devices-hands = { $count ->
    [one] one hand tracked
   *[other] { $count } hands tracked
}
devices-strain = arm strain { $percent } %
devices-rest = Your arm works high: rest it, or work lower.
devices-nothing = nothing
devices-curve = The pressure curve on the left shows the pen's live trace.
pose-neutral = Neutral
pose-point = Point
pose-pinch = Pinch
pose-grab = Grab
pose-flat = Flat
pose-open = Open

tablet-heading = Keys of the tablet
tablet-choose = Choose by pressing it
    .tip = Then press the tablet's key or the pen's button, or turn the ring. It does nothing else meanwhile
tablet-listening = Press a key of the tablet now...
tablet-usual = As usual ({ $action })
tablet-action = Action of { $control }
tablet-line = { $control }: { $action }
tablet-reset = Reset
    .tip = As usual again
tablet-none = Everything does what it usually does.
tablet-nothing = Nothing
tablet-next-mode = Next mode
tablet-radius = Radius
    .back = Radius, the other way round
tablet-strength = Strength
    .back = Strength, the other way round
tablet-turn = Turn the view while held
tablet-slide = Slide the view while held
tablet-zoom = Zoom while held
tablet-radius-and-strength = Radius and strength by dragging
tablet-carve = Carve while held
tablet-brush = Brush { $brush }
    .held = Brush { $brush } while held
control-key = Key { $number }
control-barrel = Barrel { $number }
control-eraser = Eraser
control-wheel = Wheel { $number }
control-ring = Ring { $number }
control-strip = Strip { $number }

## Page: loop

loop-heading = Loop
loop-tick = tick
loop-late = late
loop-samples = samples
loop-dabs = dabs
loop-lost = lost
    .note = lost: motion + contacts
loop-window = This window
loop-frames = frames/s
loop-frame = frame
loop-worst = worst
loop-to-clay = to clay
loop-to-screen = to screen
    .note = to clay, to screen: from the newest sample
loop-in-view = in view
loop-of = { $part } of { $all }
loop-uploaded = uploaded
loop-object = Object
loop-vertices = vertices
loop-triangles = triangles
loop-saved = saved as you work: { $path }
loop-sample-to-screen = Sample to screen
loop-up-to = up to { $value } ms
loop-longer = longer
loop-class = { $class }: { $count }
loop-histogram = { $frames } frames; { $first } ms, and twice as long with each bar
stage-tick = tick
    .about = read to the end of the tick that took it
stage-wait = wait
    .about = the end of that tick to the begin of a frame
stage-draw = draw
    .about = the begin of the frame to its picture handed over
stage-present = present
    .about = handed over to presented
stage-total = total
    .about = read to presented

## Page: more

preferences-heading = Preferences
preferences-language = Language
preferences-language-system = As the system ({ $name })
preferences-font = { $name } needs a font that this computer lacks. Install one with its letters, such as Noto Sans CJK, and choose the language again.
preferences-text-size = Text size
preferences-light = Light panels
preferences-speed = Speed is pressure
    .tip = For a mouse: slow strokes press harder than quick ones
preferences-lead = Show strokes ahead of the pen
    .tip = What the pen will raise until the picture is seen; the clay itself depends on the pen alone
preferences-fingers = Two fingers
    .tip = On a touch screen. Pinched they zoom; three fingers do the other, three tap to undo, four to do it again
preferences-fingers-turn = Turn
preferences-fingers-slide = Slide
preferences-lesson-skip = Skip the lesson
preferences-lesson-again = First lesson again
preferences-keys = Keys...
preferences-help = Help
preferences-search = Search actions
preferences-no-session = No session file: the sculpture is kept only when you export it.

messages-heading = Messages
messages-loading = Loading { $name }

## The window of the keys

keys-heading = Keys
keys-set = Set
keys-as-in-set = As in the set
    .tip = Forgets every key that you have changed
keys-find = Find
keys-note = Click on the keys of an action to change them.
keys-shared = { $count ->
    [one] { $count } action shares keys with another one
   *[other] { $count } actions share keys with another one
}
keys-press = Press keys...
keys-of = Keys of { $action }
    .tip = Click, then press the new keys. Escape leaves them, Delete takes them away
keys-also = also: { $actions } (a chosen one goes before)
    .own = also: { $actions } (this one is done)
keys-unknown-action = keys.own: no action is called "{ $id }"
keys-unreadable = keys.own.{ $id }: "{ $keys }" is no key: expected one such as Z, F12, [ or Ctrl+Shift+Z

## Search, radial menu, dragged settings, curves

search-heading = Search actions
search-nothing = nothing is called that

radial-radius = Radius
radial-mirror = Mirror x
radial-thickness = Thickness
radial-frame = Frame
radial-strength = Strength
radial-carve = Carve

modal-radius = Radius { $value }: click to keep, Esc to leave as it was
modal-strength = Strength { $value }: click to keep, Esc to leave as it was

curve-note = Draw, or set points: they can be changed before the brush follows.
curve-points = { $count ->
    [one] { $count } point
   *[other] { $count } points
}
curve-draw = Draw the curve
    .tip = The brush follows it, as one step (Enter)
curve-remove = Remove the point
    .tip = Delete, or the right button upon it
curve-discard = Discard
    .tip = Nothing is drawn (Esc)

## The first lesson

lesson-demo = The demo is running. Touch the clay at any time
lesson-line = { $hint } ({ $at } of { $all })
lesson-sculpt = Press and drag on the clay
lesson-turn = Drag beside the clay to turn it, scroll to zoom
lesson-smooth = Hold Shift and stroke over what you made: it becomes smooth
lesson-carve = Hold Ctrl and stroke: it carves instead of raising
lesson-undo = { $keys } takes the last stroke back
lesson-mirror = { $keys }, or Mirror x at the left, and a stroke: both sides
    .no-keys = Choose x under Mirror at the left, and make a stroke: both sides

## Help

help-heading = Help
help-pages = Pages at the right
help-keys = Keys
help-pen = Pen or mouse
help-pen-press = Press and drag on the clay
    .does = Sculpt
help-pen-carve = The same with Ctrl or Alt
    .does = Carve instead of raise, for one stroke
help-pen-smooth = The same with Shift
    .does = Smooth, for one stroke
help-pen-turn = Drag beside the clay, or with the right button
    .does = Turn the view
help-pen-slide = Middle button, or right button with Shift
    .does = Slide the view
help-pen-zoom = Wheel
    .does = Come nearer to what is under the pointer
help-pen-menu = Hold Space
    .does = Menu around the pointer
help-fingers = Fingers on a screen
help-fingers-one = One finger on the clay
    .does = Sculpt
help-fingers-two = Two fingers
    .does = Turn the view; pinched they zoom
help-fingers-three = Three fingers
    .does = Slide the view (page More exchanges the two)
help-fingers-tap = Tap with three, with four
    .does = Undo, redo
help-hands = Bare hands over a tracker
help-hands-index = Index finger stretched
    .does = The fingertip pushes the clay
help-hands-pinch = Thumb and index finger closed
    .does = Hold clay, carry it, let it go
help-hands-flat = Fingers stretched and together
    .does = The palm presses and smooths
help-hands-open = Fingers stretched and apart
    .does = Turn the view; with two hands zoom
help-hands-fist = Fist
    .does = Slide the view
help-hands-both = Pinch with both hands
    .does = Hold the sculpture: turn, move, scale it
help-hands-menu = A fingertip rests in a ball at the left
    .does = Choose from the menu of the hands
help-work = Work is kept
help-work-close = Close the window at any time
    .does = The session goes on where it was
help-work-files = Page Files
    .does = Open, export, earlier sculptures

## Actions

action-brush = { $brush } brush
action-page = Page: { $page }
action-undo = Undo
action-redo = Redo
action-carve = Carve or raise
action-larger = Larger brush
action-smaller = Smaller brush
action-stronger = Stronger brush
action-weaker = Weaker brush
action-drag-radius = Drag the radius
action-drag-strength = Drag the strength
action-sample-colour = Sample the colour
action-mirror-x = Mirror over x
action-mirror-y = Mirror over y
action-mirror-z = Mirror over z
action-frame = Frame the sculpture
action-front = View from the front
action-back = View from behind
action-left = View from the left
action-right = View from the right
action-top = View from above
action-bottom = View from below
action-perspective = Perspective or orthographic
action-four-views = Four views or one
action-next-material = Next material
action-facets = Smooth or flat shading
action-ssao = Ambient occlusion
action-shadows = Shadows
action-wireframe = Wireframe
action-grid = Grid
action-thickness = Thickness map
action-mask = Mask map
action-distance = Distance map
action-trim-box = Trim by a box
action-trim-line = Trim by a line
action-region-lasso = Region by a lasso
action-region-box = Region by a box
action-region-line = Region by a line
action-region-polyline = Region by a polyline
action-region-mask = Mask a region
action-region-unmask = Unmask a region
action-region-hide = Hide a region
action-region-isolate = Show only a region
action-region-face-set = Face set of a region
action-finer = Finer level
action-coarser = Coarser level
action-remesh = Remesh
action-try-add = Preview: add the held object
action-try-cut = Preview: cut with the held object
action-try-keep = Preview: keep what both share
action-open-mesh = Open a mesh
action-export = Export the mesh
action-screenshot = Screenshot
action-turntable = Turntable frames
action-search = Search actions
action-panels = Panels
action-light-or-dark = Light or dark
action-larger-text = Larger text
action-smaller-text = Smaller text
action-help = Help
action-keys = Change the keys
action-lesson = First lesson

## Messages of background tasks

task-loaded = { $name }: { $count } vertices
task-exported = Saved { $path }: { $x } x { $y } x { $z } { $unit }
task-saved = Saved { $path }
task-frames = Saved { $frames } frames to { $folder }
task-failed = { $path }: { $error }
task-done = { $operation }: done
task-snapped = The faces now touch
task-mirrored = A mirrored twin was added
task-trimmed = Trimmed
task-level = Level { $at } of { $all }
task-remesh-local = Edges changed: { $count }
task-remesh-taken-back = The remesh was undone before it finished.
task-remeshed = Remeshed: { $count } triangles, voxels of { $voxel }, volume { $change } %; crossings: { $crossings }
task-remesh-lost = Parts thinner than a voxel are lost, for instance at { $x }, { $y }, { $z }: undo, and use a smaller voxel
task-quads = { $quads } quads and { $triangles } triangles; crossings: { $crossings }
task-decimated = { $before } triangles became { $now }; new crossings: { $crossings }
task-layers-baked = Layers baked into the new surface: { $count }
task-sets-made = Face sets made
task-mask-measured = Masked: { $count } vertices
task-sets-dropped = The face sets went with the old surface; nothing is hidden any more
task-extracted = Extracted an object of { $count } vertices
task-preferences-unreadable = { $path }: { $error }; it is kept as { $aside }
task-preferences-stuck = { $path }: { $error }; it cannot be set aside: { $why }
task-brush-saved = The brush { $name } is saved
task-brush-not-saved = The brush is not saved: { $error }
task-picture-kept = Kept as { $path }
task-preferences-unread = { $path }: the preferences cannot be read: { $error }
task-preferences-not-kept = { $path }: the preferences are not kept: { $error }
language-unreadable = { $path }: { $error }

## People who share the sculpture

people-heading = People
people-you = { $name } (you)
people-gone = Gone: { $names }
people-sculptor = sculptor
people-viewer = viewer
people-device = device
people-invite = Invite by a code
people-invite-about = Scan this code with a phone or tablet in your network, or open the link. Guests sculpt in the browser.
people-invite-copy = Copy the link
undo-in-the-way = Undo refused: { $name } has changed the same place since. { $name } has to undo that first.
redo-in-the-way = Not done again: { $name } has changed the same place since. Once { $name } has taken that back, it can be.
