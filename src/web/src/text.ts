// The words of the page. English is complete; a language that lacks a word shows the English one.

const ENGLISH = {
  title: "Sculpture",
  connecting: "Connecting…",
  lost: "Connection lost. Trying again…",
  watching: "You are watching",
  sculpting: "You are sculpting",
  tablet: "Your pen is a tablet of the screen",
  noKey: "Open this page by its link or its code: it carries the key.",
  tools: "Brush",
  kind: "Brush",
  radius: "Radius",
  strength: "Strength",
  colour: "Colour",
  negative: "Carve",
  mirror: "Mirror",
  finger: "Finger sculpts",
  undo: "Undo",
  redo: "Redo",
  home: "Show all",
  follow: "Follow host",
  host: "host",
  vertices: "vertices",
  name: "Your name",
  walls: "Thickness",
  takeHome: "Take home",
  glb: "To look at, with colours (GLB)",
  stl: "For a 3D printer (STL)",
};

export type Word = keyof typeof ENGLISH;

const OTHERS: Record<string, Partial<Record<Word, string>>> = {
  de: {
    title: "Skulptur", connecting: "Verbinden …", lost: "Verbindung verloren. Neuer Versuch …",
    watching: "Du siehst zu", sculpting: "Du modellierst", tablet: "Dein Stift ist ein Tablett des Bildschirms",
    noKey: "Öffne diese Seite über ihren Link oder Code: er enthält den Schlüssel.",
    tools: "Pinsel", kind: "Pinsel", radius: "Radius", strength: "Stärke", colour: "Farbe", negative: "Abtragen",
    mirror: "Spiegeln", finger: "Finger modelliert", undo: "Rückgängig", redo: "Wiederholen",
    home: "Alles zeigen", follow: "Gastgeber folgen", host: "Gastgeber", vertices: "Punkte", name: "Dein Name",
    walls: "Wandstärke", takeHome: "Mitnehmen", glb: "Zum Ansehen, mit Farben (GLB)", stl: "Für einen 3D-Drucker (STL)",
  },
  fr: {
    title: "Sculpture", connecting: "Connexion…", lost: "Connexion perdue. Nouvel essai…",
    watching: "Vous regardez", sculpting: "Vous sculptez", tablet: "Votre stylet est une tablette de l’écran",
    noKey: "Ouvrez cette page par son lien ou son code : il contient la clé.",
    tools: "Brosse", kind: "Brosse", radius: "Rayon", strength: "Force", colour: "Couleur", negative: "Creuser",
    mirror: "Miroir", finger: "Le doigt sculpte", undo: "Annuler", redo: "Rétablir",
    home: "Tout voir", follow: "Suivre l’hôte", host: "hôte", vertices: "sommets", name: "Votre nom",
    walls: "Épaisseur", takeHome: "Emporter", glb: "À regarder, en couleurs (GLB)", stl: "Pour une imprimante 3D (STL)",
  },
  es: {
    title: "Escultura", connecting: "Conectando…", lost: "Conexión perdida. Reintentando…",
    watching: "Estás mirando", sculpting: "Estás esculpiendo", tablet: "Tu lápiz es una tableta de la pantalla",
    noKey: "Abre esta página con su enlace o su código: contiene la clave.",
    tools: "Pincel", kind: "Pincel", radius: "Radio", strength: "Fuerza", colour: "Color", negative: "Tallar",
    mirror: "Espejo", finger: "El dedo esculpe", undo: "Deshacer", redo: "Rehacer",
    home: "Ver todo", follow: "Seguir al anfitrión", host: "anfitrión", vertices: "vértices", name: "Tu nombre",
    walls: "Grosor", takeHome: "Llevar", glb: "Para ver, con colores (GLB)", stl: "Para una impresora 3D (STL)",
  },
  it: {
    title: "Scultura", connecting: "Connessione…", lost: "Connessione persa. Nuovo tentativo…",
    watching: "Stai guardando", sculpting: "Stai scolpendo", tablet: "La tua penna è una tavoletta dello schermo",
    noKey: "Apri questa pagina dal suo link o codice: contiene la chiave.",
    tools: "Pennello", kind: "Pennello", radius: "Raggio", strength: "Forza", colour: "Colore", negative: "Scava",
    mirror: "Specchio", finger: "Il dito scolpisce", undo: "Annulla", redo: "Ripeti",
    home: "Mostra tutto", follow: "Segui l’ospite", host: "ospite", vertices: "vertici", name: "Il tuo nome",
    walls: "Spessore", takeHome: "Porta a casa", glb: "Da guardare, a colori (GLB)", stl: "Per una stampante 3D (STL)",
  },
  el: {
    title: "Γλυπτό", connecting: "Σύνδεση…", lost: "Η σύνδεση χάθηκε. Νέα προσπάθεια…",
    watching: "Παρακολουθείτε", sculpting: "Πλάθετε", tablet: "Η γραφίδα σας είναι ταμπλέτα της οθόνης",
    noKey: "Ανοίξτε τη σελίδα με τον σύνδεσμο ή τον κωδικό της: περιέχει το κλειδί.",
    tools: "Πινέλο", kind: "Πινέλο", radius: "Ακτίνα", strength: "Ένταση", colour: "Χρώμα", negative: "Αφαίρεση",
    mirror: "Καθρέφτης", finger: "Το δάχτυλο πλάθει", undo: "Αναίρεση", redo: "Επανάληψη",
    home: "Προβολή όλων", follow: "Όπως ο οικοδεσπότης", host: "οικοδεσπότης", vertices: "κορυφές", name: "Το όνομά σας",
    walls: "Πάχος", takeHome: "Πάρτε το", glb: "Για προβολή, με χρώματα (GLB)", stl: "Για τρισδιάστατο εκτυπωτή (STL)",
  },
  ja: {
    title: "彫刻", connecting: "接続中…", lost: "接続が切れました。再接続中…",
    watching: "観覧中", sculpting: "彫刻中", tablet: "あなたのペンが画面のタブレットになります",
    noKey: "リンクまたはコードからこのページを開いてください。鍵が含まれています。",
    tools: "ブラシ", kind: "ブラシ", radius: "半径", strength: "強さ", colour: "色", negative: "削る",
    mirror: "対称", finger: "指で彫る", undo: "元に戻す", redo: "やり直す",
    home: "全体表示", follow: "ホストに追従", host: "ホスト", vertices: "頂点", name: "お名前",
    walls: "厚み", takeHome: "持ち帰る", glb: "見るため、色つき (GLB)", stl: "3Dプリンター用 (STL)",
  },
  zh: {
    title: "雕塑", connecting: "正在连接…", lost: "连接已断开，正在重试…",
    watching: "您正在观看", sculpting: "您正在雕刻", tablet: "您的笔是屏幕的数位板",
    noKey: "请通过链接或二维码打开此页面：其中包含密钥。",
    tools: "笔刷", kind: "笔刷", radius: "半径", strength: "强度", colour: "颜色", negative: "雕除",
    mirror: "镜像", finger: "手指雕刻", undo: "撤销", redo: "重做",
    home: "显示全部", follow: "跟随主机", host: "主机", vertices: "顶点", name: "您的名字",
    walls: "厚度", takeHome: "带回家", glb: "用于观看，含颜色 (GLB)", stl: "用于3D打印 (STL)",
  },
};

const language = navigator.languages.map((l) => l.slice(0, 2)).find((l) => l === "en" || l in OTHERS);
const words = OTHERS[language ?? "en"] ?? {};

export function say(word: Word): string {
  return words[word] ?? ENGLISH[word];
}

export function setLanguage(): void {
  document.documentElement.lang = language ?? "en";
}
