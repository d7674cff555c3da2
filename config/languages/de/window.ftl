# What the window says in German; config/languages/en/window.ftl holds the English of every message.

language-name = Deutsch
    .latin = Deutsch

## Keys that are held with another one

key-ctrl = Strg
key-alt = Alt
key-shift = Umschalt

## Words that many places share

off = aus
none = keine
cancel = Abbrechen
reset = Zurücksetzen
undo = Rückgängig
redo = Wiederholen
open = Öffnen
export = Exportieren
length-mm = { $value } mm
area-mm2 = { $value } mm²
volume-mm3 = { $value } mm³
time-ms = { $value } ms
percent = { $value } %
size-bytes = { $value } B
size-kilobytes = { $value } kB
size-megabytes = { $value } MB
triangles = { $count } Dreiecke
both-keys = { $first } und { $second }
name-with-keys = { $name } ({ $keys })

## Pages at the right

page-look = Ansicht
    .about = Wie der Ton gezeigt wird
page-scene = Szene
    .about = Ein zweites Objekt, boolesche Operationen, Detailstufen, Zuschneiden
page-walls = Wände
    .about = Wandstärke und dünne Stellen
page-measure = Maße
    .about = Maße, Schatten in einer Richtung, Abstände zu einer anderen Form
page-files = Dateien
    .about = Öffnen, Exportieren, Bilder
page-devices = Stifte
    .about = Geräte und ihre laufenden Werte
page-loop = Takt
    .about = Zeiten der Rechenschleife und dieses Fensters
page-more = Mehr
    .about = Sprache, Einstellungen und Meldungen

## Brushes

kind-gaussian = Gauß
    .about = Hebt eine Glocke aus Ton entlang der Flächennormalen (Cipollini 2020).
kind-smooth = Glätten
    .about = Ebnet die Fläche: Laplace-Operator mit Kotangens-Gewichten; die Stärke ist der Anteil des Wegs je Tupfer.
kind-draw = Zeichnen
    .about = Hebt die Fläche entlang ihrer mittleren Normalen, nach dem Abfall.
kind-clay = Ton
    .about = Trägt Ton flach auf: füllt bis zu einer Ebene knapp über der Fläche.
kind-clay-strips = Tonstreifen
    .about = Legt Ton in flachen Bändern mit eckigen Enden auf, die dem Strich folgen.
kind-inflate = Aufblähen
    .about = Bläht die Form auf: jeder Punkt entlang seiner eigenen Normalen.
kind-layer = Schicht
    .about = Eine gleich hohe Schicht je Strich, so oft er auch über dieselbe Stelle geht.
kind-crease = Falte
    .about = Zieht eine Rille, deren Seiten zusammenrücken; negativ einen Grat.
kind-pinch = Kneifen
    .about = Zieht die Fläche zur Mitte des Pinsels zusammen; negativ spreizt sie.
kind-blob = Klecks
    .about = Hebt einen runden Tropfen: die Fläche schwillt von einem Punkt darunter an.
kind-flatten = Abflachen
    .about = Zieht Hügel und Mulden zur mittleren Ebene; negativ vertieft sie.
kind-fill = Füllen
    .about = Füllt Mulden bis zur mittleren Ebene und lässt Hügel stehen; negativ trägt Hügel ab.
kind-scrape = Schaben
    .about = Trägt Hügel bis zur mittleren Ebene ab und lässt Mulden; negativ füllt Mulden.
kind-trim = Abschneiden
    .about = Schneidet ab, was über eine Ebene knapp unter der Fläche ragt, wie ein Messer.
kind-grab = Greifen
    .about = Was beim Aufsetzen des Stifts unter dem Pinsel lag, folgt dem Stift.
kind-elastic = Elastisch
    .about = Bewegt den Ton wie einen elastischen Körper, der an einem Punkt gehalten wird (regularisierte Kelvinlets, de Goes und James 2017).
kind-topological = Topologisch
    .about = Wie Greifen, aber gehalten wird, was entlang der Fläche nahe ist, nicht durch die Luft.
kind-snake-hook = Schlangenhaken
    .about = Zieht Ton hinter dem Stift heraus und geht mit.
kind-twist = Verdrehen
    .about = Dreht, was unter dem Pinsel lag, um die Flächennormale, wenn der Stift nach rechts geht.
kind-thumb = Daumen
    .about = Verschmiert entlang der Fläche, was unter dem Pinsel lag.
kind-nudge = Schubsen
    .about = Schiebt die Fläche mit dem Strich.
kind-relax = Entspannen
    .about = Gleicht die Dreiecke entlang der Fläche aus und lässt die Form.
kind-mask = Maske
    .about = Schützt das Bemalte vor anderen Pinseln; negativ gibt es frei.
kind-mask-blur = Maske weich
    .about = Macht die Ränder der Maske weich; negativ scharf.
kind-paint = Malen
    .about = Trägt die Farbe des Pinsels auf den Ton auf.
kind-texture = Textur
    .about = Prägt ein Alpha entlang des Strichs als Relief ein, gebogen wie der Strich und wiederholt.
kind-density = Dichte
    .about = Bringt die Dreiecke auf die gewünschte Größe, einen Anteil des Pinsels, und gleicht sie aus; die Form bleibt.
kind-simplify = Vereinfachen
    .about = Zieht kleine Dreiecke zur gewünschten Größe zusammen, einem Anteil des Pinsels; große und die Form bleiben.
kind-slide-relax = Schieben
    .about = Schiebt die Dreiecke mit dem Strich entlang der Fläche und lässt die Form; mit Umschalt oder umgekehrt entspannt er sie.
kind-plane = Ebene
    .about = Bringt Hügel und Mulden zur mittleren Ebene der Fläche, wie der Strich sie vorfand; negativ vertieft sie.
kind-multiplane-scrape = Kantenschaber
    .about = Schabt zwei Ebenen, die sich entlang des Strichs treffen: ein Grat mit flachen Seiten bleibt.
kind-sharpen = Schärfen
    .about = Hebt feines Relief hervor; negativ nimmt es zurück.
kind-surface-smooth = Fläche glätten
    .about = Ebnet die Fläche und erhält ihr Volumen (Taubin 1995).
kind-boundary = Rand
    .about = Der Rand einer offenen Fläche folgt dem Stift, und die Fläche dahinter mit ihm.
kind-erase-layer = Ebene radieren
    .about = Nimmt weg, was die aktive Ebene bewirkt; die Fläche kehrt zu dem zurück, was darunter liegt.
kind-draw-face-sets = Gruppen zeichnen
    .about = Zeichnet Flächengruppen: jeder Strich eine neue; negativ geht die Gruppe weiter, auf der er begann.

## Numbers of single brushes

number-depth = Tiefe
    .blob = wie weit dieser Punkt unter der Fläche liegt, in Radien
    .plane = wie weit die Schicht unter die Ebene reicht, in Radien
    .trim = wie weit unter der Fläche geschnitten wird, in Radien, bei voller Stärke
number-lift = Anhebung
    .about = wie weit die Ebene über der Fläche steht, in Radien, bei voller Stärke
number-fill = Füllung
    .about = der Anteil des Wegs zur Ebene je Fünftel des Radius
number-roundness = Rundung
    .about = 0 ein Quadrat, 1 eine Scheibe
number-pinch = Kneifen
    .about = wie stark die Seiten zusammengezogen werden
number-poisson = Poisson
    .about = wie weit der Ton sein Volumen behält: 0.5 ganz
number-offset = Versatz
    .about = wie weit die Ebene entlang ihrer Normalen verschoben ist, in Radien
number-angle = Winkel
    .about = zwischen den Normalen der Ebenen, in Grad
number-height = Höhe
    .about = wie weit die Schicht über die Ebene reicht, in Radien
number-scale = Größe
    .about = Länge einer Wiederholung, in Pinselbreiten
number-floor = Nullhöhe
    .about = die Höhe des Alphas, die auf der Fläche bleibt; was tiefer ist, wird eingedrückt
number-width = Breite
    .about = Breite des Alphas in Pinselbreiten: unter 1 wird es wiederholt, über 1 beschnitten
number-set = Gruppe
    .about = Nummer der Flächengruppe, die gezeichnet wird; 0: jeder Strich beginnt eine neue

## The brush's settings

brush-more = Weitere Pinsel
brush-now = Pinsel: { $name }
brush-favourites = Favoriten
brush-favourite = Favorit
    .tip = Steht an erster Stelle unter den Pinseln
brush-own = Eigene
    .tip = { $what } (noch einmal: wie gespeichert)
brush-own-about = { $kind }: { $about }
brush-radius = Radius
    .tip = Bei vollem Druck ({ $keys }, oder { $drag } und ziehen)
brush-radius-pixels = Radius in Pixeln
    .tip = Der Pinsel behält beim Zoomen seine Größe auf dem Bildschirm; aus: seine Größe auf dem Objekt
brush-strength = Stärke
    .tip = Wie viel ein Tupfer bewirkt ({ $keys }, oder { $drag } und ziehen)
brush-carve = Abtragen
    .tip = { $action }; Strg halten für einen Strich
brush-stroke = Strich
brush-settings = Weitere Einstellungen
brush-dab = Form eines Tupfers
brush-stamp = Alpha und Stempel
brush-automasks = Automatische Masken
brush-topology = Dynamische Topologie
brush-save = Diesen Pinsel speichern
    .tip = Er steht dann unter den eigenen, mit allen Einstellungen und seinem Bild
brush-save-name = Name
brush-save-new = Speichern
brush-save-replace = Ersetzen
brush-save-wrong = Bis zu 64 Buchstaben, Ziffern, Leerzeichen, - und _, und kein Name eines Pinsels des Programms

stroke-spacing = Abstand
    .tip = Abstand der Tupfer als Anteil des Radius
stroke-stabilizer = Stabilisator
    .tip = Der Pinsel folgt dem Stift in diesem Abstand: ein Anteil der Höhe der Ansicht
stroke-steadiness = Ruhe
    .tip = Länge des Fadens, an dem der Pinsel dem Stift folgt, in Radien
stroke-average = Gemittelte Punkte
    .tip = Der Pinsel geht zum Mittel aus so vielen Meldungen des Stifts
stroke-jitter = Streuung
    .tip = Wie weit Tupfer um den Weg gestreut werden, in Radien
stroke-seed = Startwert der Streuung:
stroke-method = Methode
stroke-continuous = Weiter bei ruhendem Stift
stroke-ticks = Takte zwischen Tupfern in Ruhe
stroke-compensate = Gleiche Stärke bei jedem Abstand
    .tip = Die Stärke zählt über den Weg des Stifts; aus: jeder Tupfer hat sie ganz
stroke-accumulate = Anhäufen
    .tip = Ein Strich baut auf dem auf, was er selbst gehoben hat
stroke-limit = Grenze des Strichs
    .tip = Wie weit ein Strich einen Punkt bewegen darf, in Höhen eines vollen Tupfers; 0: keine Grenze

method-space = Gleichmäßig
method-dots = Punkte
method-airbrush = Airbrush
method-anchored = Verankert
method-drag-dot = Gezogener Punkt
method-line = Linie
method-curve = Kurve aus Punkten

dab-falloff = Abfall
dab-curve-tip = Bei { $eighths } Achteln des Radius
dab-hardness = Härte
    .tip = Anteil des Radius, in dem der Pinsel voll wirkt
dab-smoothing = Glättung
    .tip = Jeder Tupfer wird mit dieser Stärke geglättet
dab-averaging = Mittelung
    .tip = Anteil des Radius, über den die Ebene der Fläche gemittelt wird
dab-plane-trim = Ebenengrenze
    .tip = Was weiter von der Ebene entfernt ist, bleibt, in Radien; 0: nichts
dab-tilt = Neigung
    .tip = Wie sehr sich ein Tupfer mit dem Stift neigt
dab-colour = Farbe

colour-sample = Aufnehmen
    .tip = { $action }: der nächste Klick auf den Ton nimmt dessen Farbe
colour-sample-here = Die Farbe auf dem Ton anklicken
colour-keep = Merken
    .tip = Die Farbe steht von nun an darunter
colour-swatch = Farbe { $code }
    .tip = { $code }: ein Klick nimmt sie, die rechte Taste entfernt sie
colour-nothing = Unter dem Zeiger ist kein Ton

falloff-gaussian = Gauß
falloff-smooth = Weich
falloff-sphere = Kugel
falloff-root = Wurzel
falloff-sharp = Spitz
falloff-linear = Linear
falloff-constant = Konstant
falloff-custom = Eigener

stamp-alpha = Alpha
stamp-stamp = Stempel
stamp-size = Stempelgröße
stamp-angle = Stempelwinkel
stamp-repeat = Stempel wiederholen
stamp-right = Schablone rechts
stamp-up = Schablone oben
stamp-at-tip = Von der Mitte der Ansicht, in deren Höhen
stamp-off = Keiner
stamp-dab = Unter jedem Tupfer
stamp-view = Entlang der Ansicht
stamp-stencil = Schablone

alpha-studs = Noppen
alpha-scales = Schuppen
alpha-rope = Seil
alpha-stitches = Nähte
alpha-waves = Wellen
alpha-bricks = Ziegel
alpha-stone = Stein
alpha-cracks = Risse
alpha-picture = Geladenes Bild

automask-front = Nur Vorderseiten
automask-topology = Nur verbundene Teile
automask-sets = Nur die Flächengruppe des ersten Tupfers
automask-boundary = Ränder bleiben
    .tip = Der Rand einer offenen Fläche bewegt sich nicht
automask-normal = Normalengrenze
    .tip = Nur was höchstens um so viel Grad von der Normalen des Tupfers abweicht; 0: alles
automask-cavity = Mulden
    .tip = Über 0 nur Mulden, unter 0 nur Grate

topology-by = Kantenlänge
topology-length = Länge
topology-split = Längere Kanten teilen
topology-collapse = Kürzere Kanten auflösen
topology-off = Aus
topology-brush = Anteil des Pinsels
topology-object = Anteil des Objekts
topology-view = Anteil der Ansicht

## Mirror, pressure, masks, history

mirror-heading = Spiegel

pressure-heading = Druck
pressure-curve = Druckkurve
    .tip = Am linken Ende ziehen für die leichteste Berührung, in der Mitte für die Biegung
pressure-lightest = Minimum
pressure-bend = Biegung
pressure-radius = Radius
    .tip = Anteil des Radius bei leichtester Berührung
pressure-radius-curve = Druckkurve des Radius
pressure-radius-bend = Biegung des Radius

mask-heading = Maske
mask-clear = Leeren
    .tip = Alles ist frei
mask-fill = Füllen
    .tip = Alles ist geschützt
mask-invert = Umkehren
    .tip = Freies wird geschützt, Geschütztes frei
mask-blur = Weicher
    .tip = Ein weicherer Rand
mask-sharpen = Schärfer
    .tip = Ein härterer Rand
mask-grow = Wachsen
    .tip = Ein Ring von Punkten mehr
mask-shrink = Schrumpfen
    .tip = Ein Ring weniger
mask-cavity = Mulden
    .tip = Mulden sind geschützt
mask-thin = Dünne Stellen
    .tip = Was höchstens so dick ist, wird festgehalten
mask-occlusion = Verdeckt
    .tip = Wovon das Objekt das Licht fernhält, wird festgehalten
mask-thin-below = dünn ist
    .tip = Anteil der längsten Seite
mask-note = { $keys } zeigt sie; der Pinsel Maske malt sie

history-heading = Verlauf
history-steps = { $at } von { $all }
history-versions = { $count ->
    [one] { $count } Version
   *[other] { $count } Versionen
}
history-step = Schritt
    .tip = Ziehen, um durch die Schritte zu gehen
history-after = Nach Schritt { $step }
history-version = Version
    .tip = Ziehen, um durch die Versionen dieser Linie zu gehen
history-row = Version { $node }, bei { $time }
history-row-branch = Version { $node }, bei { $time }, auf einem Zweig
history-replaced = ersetzt
history-added = hinzugefügt
history-removed = entfernt
history-duplicated = dupliziert
history-renamed = umbenannt
history-moved = bewegt
history-activated = aktiviert
history-shown = ein-/ausgeblendet
history-locked = ge-/entsperrt
history-reshaped = umgeformt
history-boolean = boolesch
history-merged = vereint
history-split = geteilt
history-layers = Ebenen
history-sets = Flächengruppen
history-mask = Maske
history-remesh = Dreiecksgröße
history-snapped = bündig gelegt
history-arranged = umgeordnet
history-set-named = Flächensatz benannt
history-followed = den Operanden gefolgt
history-applied = Boolesche angewandt
history-mirrored = gespiegelt

## Page: look

look-material = Material
material-clay = Ton
material-porcelain = Porzellan
material-wax = Wachs
material-stone = Stein
material-jade = Jade
material-bronze = Bronze
material-graphite = Graphit
material-steel = Stahl
light-name = Licht
    .tip = Umgebungsbilder (HDR, EXR) und quadratische Bilder beleuchteter Kugeln werden behalten, wenn man sie auf das Fenster zieht
light-studio = Studio
light-room = Raum
light-matcap = Beleuchtete Kugel
light-turned = Drehung
light-raised = Höhe
light-shadow = Schatten
    .tip = { $action }: was im Hauptlicht steht, verdunkelt, was dahinter liegt
light-bright = Helligkeit
reference-name = Vorlage
    .tip = Ein nicht quadratisches Bild auf das Fenster ziehen
reference-none = Keine
reference-behind = Hinter dem Ton
reference-opacity = Deckkraft
look-facets = Facetten
look-cavity = Mulden
    .tip = Mulden dunkler, Grate heller
look-occlusion = Verdeckung
    .tip = { $action }: Umgebungsverdeckung im Bildraum
look-wireframe = Drahtgitter
look-grid = Raster
look-smooth-edges = Glatte Kanten
    .tip = Vier Abtastungen je Pixel; kostet Zeit, wo keine Grafikkarte zeichnet
look-map = Karte
map-none = Keine
    .tip = Der Ton selbst
map-mask = Maske
map-thickness = Wandstärke
map-distance = Abstand
look-camera = Kamera
look-orthographic = Orthografisch
look-angle = Winkel
    .tip = Blickfeld, Grad
look-four-views = Vier Ansichten
view-top = Von oben
view-free = Frei
view-front = Von vorn
view-right = Von rechts
view-alone = Zeigt diese Ansicht allein, wie ein Doppelklick neben dem Ton. { $action } führt hin und zurück.
views-no-copies = Vier Ansichten brauchen eine Anzeige, in die sich Bilder kopieren lassen; dieser Treiber bietet das nicht. Es geht in einer Ansicht weiter.
look-keep = Ansicht merken
    .tip = Merkt sich diese Ansicht unter einer Nummer
    .show = Zeigt diese Ansicht wieder; ein Rechtsklick vergisst sie
legend-measuring = misst

## Page: scene

scene-object = Objekt
scene-size = { $x } x { $y } x { $z } { $unit }
scene-held = Gehaltenes Objekt
    .tip = Erscheint neben dem Objekt, um hineinbewegt zu werden
scene-held-note = Eine Form nehmen, an ihren Platz bewegen, dann vereinen, schneiden oder behalten.
scene-add = Vereinen
    .tip = Aus beiden wird eines
scene-cut = Schneiden
    .tip = Das Gehaltene wird aus dem Objekt geschnitten
scene-keep = Schnitt
    .tip = Nur was in beiden liegt, bleibt
scene-put-down = Absetzen
    .tip = Es wird dort, wo es ist, zum Objekt
scene-put-away = Weglegen
scene-busy = rechnet im Hintergrund: einfach weiterarbeiten
scene-preview = Vorschau
scene-computing = rechnet ...
scene-shown = { $count } Dreiecke des gehaltenen Objekts
scene-apply = Anwenden
    .tip = Tun, was gezeigt wird
scene-dismiss = Verwerfen
    .tip = Das Objekt bleibt, wie es ist; das gehaltene auch
scene-yaw = Gieren
scene-pitch = Nicken
scene-roll = Rollen
scene-scale = Skalierung
scene-held-size = Größe

objects-heading = Objekte
objects-add = Objekt hinzufügen
objects-duplicate = Duplizieren
objects-rename = Umbenennen
objects-remove = Entfernen
objects-locked = Gesperrt: kein Strich, keine Bewegung, kein Entfernen
objects-group = Gruppe
    .tip = Benennt die Gruppe, in der das Objekt steht; ein leerer Name beendet sie
objects-mirror = Spiegeln
objects-live = Boolesche folgen
    .tip = Die Operanden bleiben verborgen, und das Ergebnis wird neu berechnet, wenn einer bewegt oder geändert wird
objects-follows = Folgt seinen Operanden
objects-apply = Anwenden
    .tip = Die Operanden verschwinden, das Ergebnis bleibt, wie es ist
objects-gizmo = Gizmo
    .tip = Verschiebt, dreht und skaliert das Objekt mit dem Zeiger; mit Strg in Schritten
objects-snap = Fläche an Fläche legen
    .tip = Legt eine ebene Fläche eines Objekts bündig an eine eines anderen
objects-snap-first = Auf die Fläche drücken, die bewegt wird
objects-snap-second = Auf die Fläche drücken, an die sie kommt
objects-eye = Auge
    .tip = Wird gezeichnet
objects-lock = Sperre
    .tip = Vor Strichen, Bewegung und Entfernen geschützt
objects-reset-place = Lage zurücksetzen
    .tip = Zurück an den Ort der Entstehung
shape-box = Quader
shape-ball = Kugel
shape-cylinder = Zylinder
shape-cone = Kegel
shape-torus = Torus
shape-tube = Rohr
shape-plane = Ebene
operation-all = Alle vier
    .tip = Vereinigung, Schnitt und beide Differenzen, je ein Objekt
operation-union = Vereinigung
    .tip = Das aktive Objekt und dieses werden eines
operation-intersection = Schnittmenge
    .tip = Nur was in beiden liegt, bleibt
operation-difference = Differenz
    .tip = Dieses Objekt wird aus dem aktiven geschnitten
operation-reverse-difference = Umgekehrte Differenz
    .tip = Das aktive wird aus diesem geschnitten

sets-heading = Flächengruppen
sets-eye-tip = Flächengruppe zeigen oder verbergen
sets-colours = Farbig zeigen
sets-isolate = nur
    .tip = Verbirgt alles außer dieser Flächengruppe
sets-draw = zeichnen
    .tip = Nimmt den Pinsel, der diese Flächengruppe zeichnet
sets-none = in keiner Gruppe: { $count }
sets-row = Gruppe { $number }: { $count }
sets-hide-masked = Maskiertes verbergen
    .tip = Verbirgt, was mindestens halb maskiert ist
sets-invert = Sichtbares umkehren
    .tip = Verbirgt Sichtbares und zeigt Verborgenes
sets-show-all = Alles zeigen
    .tip = Nichts ist mehr verborgen
sets-clear = Gruppen auflösen
    .tip = Kein Punkt ist mehr in einer Gruppe; Verborgenes bleibt verborgen
sets-from-mask = Aus Maske
    .tip = Was mindestens halb maskiert ist, wird eine Gruppe
sets-from-visible = Aus Sichtbarem
    .tip = Alles Sichtbare wird eine Gruppe
sets-loose = Lose Teile
    .tip = Jedes zusammenhängende Teil wird eine Gruppe
sets-normals = Nach Richtung
    .tip = Jedes Teil, das etwa in eine Richtung zeigt, wird eine Gruppe
sets-crease = Nach Kanten
    .tip = Gruppen treffen sich, wo die Fläche stärker als der Winkel knickt
sets-degrees = Winkel
sets-thickness = Dicke
    .tip = Anteil der längsten Seite; unter 0 nach innen
sets-extract-mask = Maske herauslösen
    .tip = Maskiertes wird ein eigenes Objekt: eine geschlossene Schale dieser Dicke
sets-extract-name = Auszug

layers-heading = Ebenen
layers-add = Ebene hinzufügen
    .tip = Striche gehen auf die neue Ebene
layers-name = Ebene { $number }
layers-base = Basis
    .tip = Striche liegen unter allen Ebenen
layers-unseen = Die aktive Ebene ist verborgen oder ihre Intensität 0: Striche wären nicht zu sehen
layers-topology = Die dynamische Topologie ruht, solange das Objekt Ebenen hat; dafür müssen sie eingerechnet werden
layers-eye = Auge
    .tip = Sichtbar
layers-up = Höher
    .tip = Über die nächste Ebene
layers-down = Tiefer
    .tip = Unter die nächste Ebene
layers-merge = Nach unten vereinen
    .tip = Fügt sie der Ebene darunter oder der Basis hinzu. Beide müssen sichtbar sein
layers-duplicate = Ebene duplizieren
    .tip = Ein verborgener Zwilling darüber
layers-clear = Ebene leeren
    .tip = Nimmt weg, was sie bewirkt
layers-remove = Ebene entfernen
    .tip = Entfernt sie mit dem, was sie bewirkt
layers-rename = Ebene umbenennen
layers-bake = Ebenen einrechnen
    .tip = Die Fläche, wie sie ist, wird zur Basis

levels-heading = Stufen
levels-at = Stufe { $at } von { $all }, { $count } Dreiecke
levels-coarser = Gröber
    .tip = Das Ganze formen; das Detail feinerer Stufen geht mit
levels-finer = Feiner
    .tip = Vier Dreiecke für jedes
    .back = Zurück zur feineren Stufe

remesh-heading = Remesh
remesh-own = Eigene Voxelgröße
    .tip = Sonst werden die neuen Dreiecke etwa so groß wie die jetzigen
remesh-voxel = Voxel
remesh-along = { $count } entlang der längsten Seite
remesh-sharp = Scharfe Kanten erhalten
remesh-button = Remesh
    .tip = Eine Fläche gleichmäßiger Dreiecke; überlappende Teile werden eins. { $keys }
remesh-local-heading = An Ort und Stelle
remesh-local-edge = Kantenlänge
    .tip = Mal die übliche Kantenlänge des Objekts
remesh-local-undo = { $keys } nimmt es jederzeit zurück, auch solange es läuft.
remesh-stretched = Gedehntes verfeinern
    .tip = Teilt zu lange Kanten im ganzen Objekt; Maskiertes und Verborgenes bleibt

quads-heading = Vierecke
quads-count = Vierecke
quads-levels = feinere Stufen
    .tip = Die Vierecke sind die unterste Stufe; feinere Stufen bringen die Details zurück
quads-button = Vierecke erzeugen
    .tip = Vierecke, die der Form folgen; ein Export ohne Stufen schreibt sie

decimate-heading = Dezimieren
decimate-share = der Dreiecke
decimate-button = Dezimieren
    .tip = Weniger Dreiecke, für Druck und Web. Nichts durchdringt sich neu, und der Rand der Maske bleibt

trim-heading = Zuschneiden
trim-box = Rahmen
    .tip = Einen Rahmen über die Ansicht ziehen: was darin liegt, wird ganz hindurch abgeschnitten
trim-line = Linie
    .tip = Eine Linie über die Ansicht ziehen: was links von ihr liegt, wird abgeschnitten
trim-note = Über die Ansicht ziehen; Esc bricht ab.

region-heading = Bereich der Ansicht
region-draw = Bereich:
region-lasso = Lasso
    .tip = Um das Gemeinte ziehen
region-box = Rahmen
    .tip = Von Ecke zu Ecke ziehen
region-line = Linie
    .tip = Eine Linie ziehen: gemeint ist, was links von ihr liegt
region-polyline = Polygon
    .tip = Ecke für Ecke klicken
region-front = Nur Vorderseiten
    .tip = Nur was zum Auge zeigt; sonst ganz hindurch
region-mask = Maskieren
    .tip = Schützt, was im Bereich liegt; mit Strg: gibt es frei
region-unmask = Freigeben
    .tip = Gibt frei, was im Bereich liegt; mit Strg: schützt es
region-hide = Verbergen
    .tip = Verbirgt, was im Bereich liegt; mit Strg: alles andere
region-isolate = Nur zeigen
    .tip = Verbirgt alles andere; mit Strg: was im Bereich liegt
region-face-set = Gruppe
    .tip = Was im Bereich liegt, wird eine neue Flächengruppe
region-remesh = Dreiecksgröße
    .tip = Dreiecke im Bereich bekommen diese Kantenlänge, durch das ganze Objekt hindurch
region-done = Fertig
    .tip = Beendet das Zeichnen von Bereichen (Esc)
region-note = Über die Ansicht ziehen. Strg kehrt es um, Esc beendet.
region-polyline-note = Jede Ecke klicken; die erste oder letzte nochmals, oder Enter, schließt.

menu-add = vereinen
menu-carve = abtragen
menu-keep = Gemeinsames behalten
menu-put-away = weglegen
menu-ball = Kugel
menu-box = Quader
menu-cylinder = Zylinder
menu-undo = rückgängig
menu-redo = wiederholen
menu-pick-up = aufheben

## Page: walls

walls-heading = Wandstärke
walls-live = Laufende Karte
walls-process = Verfahren
walls-own-limit = eigene Grenze
walls-too-thin-below = Zu dünn unter
walls-note = { $keys } drücken: die Karte folgt dem Ton beim Formen.
walls-thinnest = dünnste
walls-median = Median
walls-thickest = dickste
walls-too-thin = zu dünn
walls-measured = gemessen
walls-spots = Dünne Stellen
walls-none = Keine unter der Grenze.
walls-spot = { $number }: { $value } mm
    .tip = Die Kamera fliegt dorthin
walls-histogram = Histogramm der Stärke
    .tip = { $min } bis { $max } mm; die Linie ist die Grenze
process-abs = Spritzguss, ABS
process-fdm = Schmelzschichtung (FDM)
process-pa = Spritzguss, Polyamid (PA)
process-pc = Spritzguss, Polycarbonat (PC)
process-pom = Spritzguss, Polyacetal (POM)
process-pp = Spritzguss, Polypropylen (PP)
process-sla = Stereolithografie (SLA)
process-sls = Lasersintern (SLS)

## Page: size

measure-heading = Maße
measure-waits = Gemessen wird, wenn sich nichts ändert.
measure-volume = Volumen
measure-area = Fläche
measure-size = Maß { $axis }
measure-shadow = Schatten { $axis }
measure-stale = Von einem früheren Stand; neu gemessen wird, wenn sich nichts ändert.
shadow-heading = Schatten
shadow-along = Schatten entlang { $axis }
    .tip = Entlang { $axis } gesehen
shadow-here = Von hier
    .tip = So gesehen wie die Kamera
shadow-size = { $x } x { $y } mm, { $holes } Löcher
shadow-file = Zeichnung, die geschrieben wird
    .tip = Die Datei der Zeichnung
shadow-write = SVG
    .tip = Der Umriss als maßstäbliche Zeichnung, Millimeter
shadow-outline = Umriss des Schattens
distance-heading = Abstand
distance-live = Laufende Abstandskarte
distance-before = zu vorher
    .tip = Zum Objekt, wie es geöffnet wurde
distance-held = zum gehaltenen Objekt
distance-now = Mit jetzt vergleichen
    .tip = Abstände werden zum jetzigen Objekt gemessen
distance-note = Blau liegt innen, Rot außen.
distance-deepest = tiefste
distance-highest = höchste
distance-rms = RMS
distance-known = bekannt

## Page: files

files-open = Öffnen
    .note = Ein Mesh auf das Fenster ziehen, oder:
files-open-name = Zu öffnende Datei
files-browse = Durchsuchen...
files-recent = Zuletzt geöffnet
files-earlier = Frühere Skulpturen
files-export = Exportieren
files-export-name = Zu schreibende Datei
files-scale = Maßstab
files-unit = Einheit
unit-pixel = px
unit-mm = mm
unit-cm = cm
unit-m = m
unit-inch = Zoll
files-save-as = Speichern als...
files-pictures = Bilder
files-screenshot = Bildschirmfoto
files-turntable = Drehteller
files-frames = Bilder
files-replace = Ersetzen
    .question = { $path } gibt es schon. Ersetzen?

chooser-open = Ein Mesh öffnen
chooser-export = Die Skulptur exportieren
chooser-meshes = Meshes
chooser-home = Persönlich
chooser-documents = Dokumente
chooser-downloads = Downloads
chooser-desktop = Schreibtisch
chooser-up = Aufwärts
chooser-reading = liest...
chooser-empty = hier sind weder Ordner noch Mesh-Dateien
chooser-name = Name

start-heading = Weiter mit
start-note = Diese neue Skulptur wird beim Arbeiten gespeichert.
start-stay = Hier bleiben
start-session = { $object }, { $date } { $time }

## Page: pens

devices-heading = Geräte
devices-none = Kein Tablett gefunden: einfach anschließen, ohne Neustart.
    .mouse = Auch die Maus formt: langsame Striche drücken stärker.
devices-camera = Kamera
    .privacy = Die Bilder bleiben in diesem Programm und werden nicht gespeichert.
devices-in-range = Jetzt in Reichweite
devices-pointer = Zeiger
devices-tablet = Tablett { $number }
devices-serial = serieller Stift { $number }
devices-recording = Aufzeichnung { $number }
devices-demo = Demostift { $number }
devices-pen = Stift { $number }
devices-eraser = { $pen }, Radierer
devices-no-tilt = keine Neigung
devices-tilt = Neigung { $x }, { $y } Grad
devices-pressure = Druck { $pressure }, { $tilt }
devices-place = bei { $x } %, { $y } % der Ansicht
devices-hands = { $count ->
    [one] eine Hand erkannt
   *[other] { $count } Hände erkannt
}
devices-strain = Armbelastung { $percent } %
devices-rest = Der Arm arbeitet hoch: ausruhen oder tiefer arbeiten.
devices-nothing = nichts
devices-curve = Die Druckkurve links zeigt die laufende Spur des Stifts.
pose-neutral = Neutral
pose-point = Zeigen
pose-pinch = Pinzettengriff
pose-grab = Faust
pose-flat = Flach
pose-open = Offen

tablet-heading = Tasten des Tabletts
tablet-choose = Durch Drücken wählen
    .tip = Dann die Taste des Tabletts oder den Knopf des Stifts drücken oder den Ring drehen. Sie tut solange nichts anderes
tablet-listening = Jetzt eine Taste drücken...
tablet-usual = Wie üblich ({ $action })
tablet-action = Aktion von { $control }
tablet-line = { $control }: { $action }
tablet-reset = Zurücksetzen
    .tip = Wieder wie üblich
tablet-none = Alles tut, was es üblicherweise tut.
tablet-nothing = Nichts
tablet-next-mode = Nächster Modus
tablet-radius = Radius
    .back = Radius, umgekehrt
tablet-strength = Stärke
    .back = Stärke, umgekehrt
tablet-turn = Gehalten: Ansicht drehen
tablet-slide = Gehalten: Ansicht schieben
tablet-zoom = Gehalten: Zoom
tablet-radius-and-strength = Radius und Stärke durch Ziehen
tablet-carve = Gehalten: abtragen
tablet-brush = Pinsel { $brush }
    .held = Gehalten: Pinsel { $brush }
control-key = Taste { $number }
control-barrel = Stiftknopf { $number }
control-eraser = Radierer
control-wheel = Rad { $number }
control-ring = Ring { $number }
control-strip = Streifen { $number }

## Page: loop

loop-heading = Schleife
loop-tick = Takt
loop-late = verspätet
loop-samples = Messungen
loop-dabs = Tupfer
loop-lost = verloren
    .note = verloren: Bewegung + Kontakte
loop-window = Dieses Fenster
loop-frames = Bilder/s
loop-frame = Bild
loop-worst = längstes
loop-to-clay = zum Ton
loop-to-screen = zum Schirm
    .note = zum Ton, zum Schirm: ab der neuesten Messung
loop-in-view = im Blick
loop-of = { $part } von { $all }
loop-uploaded = gesendet
loop-object = Objekt
loop-vertices = Punkte
loop-triangles = Dreiecke
loop-saved = beim Arbeiten gespeichert: { $path }
loop-sample-to-screen = Von der Messung zum Schirm
loop-up-to = bis { $value } ms
loop-longer = länger
loop-class = { $class }: { $count }
loop-histogram = { $frames } Bilder; { $first } ms, je Balken doppelt so lang
stage-tick = Takt
    .about = vom Lesen bis zum Ende des Takts, der es nahm
stage-wait = Warten
    .about = vom Ende dieses Takts bis zum Beginn eines Bilds
stage-draw = Zeichnen
    .about = vom Beginn des Bilds bis zu seiner Übergabe
stage-present = Zeigen
    .about = von der Übergabe bis zum Zeigen
stage-total = gesamt
    .about = vom Lesen bis zum Zeigen

## Page: more

preferences-heading = Einstellungen
preferences-language = Sprache
preferences-language-system = Wie das System ({ $name })
preferences-font = { $name } braucht eine Schrift, die diesem Rechner fehlt. Eine mit ihren Zeichen installieren, etwa Noto Sans CJK, und die Sprache erneut wählen.
preferences-text-size = Schriftgröße
preferences-light = Helle Felder
preferences-speed = Tempo ist Druck
    .tip = Für eine Maus: langsame Striche drücken stärker als schnelle
preferences-lead = Strich dem Stift vorauszeigen
    .tip = Was der Stift auftragen wird, bis das Bild zu sehen ist; der Ton selbst hängt nur vom Stift ab
preferences-fingers = Zwei Finger
    .tip = Auf einem Touchscreen. Zusammengezogen zoomen sie; drei Finger tun das andere, Tippen mit dreien macht rückgängig, mit vieren wiederholt es
preferences-fingers-turn = Drehen
preferences-fingers-slide = Schieben
preferences-lesson-skip = Lektion überspringen
preferences-lesson-again = Erste Lektion wiederholen
preferences-keys = Tasten...
preferences-help = Hilfe
preferences-search = Aktionen suchen
preferences-no-session = Keine Sitzungsdatei: die Skulptur bleibt nur erhalten, wenn sie exportiert wird.

messages-heading = Meldungen
messages-loading = Lädt { $name }

## The window of the keys

keys-heading = Tasten
keys-set = Satz
keys-as-in-set = Wie im Satz
    .tip = Vergisst jede geänderte Taste
keys-find = Suchen
keys-note = Auf die Tasten einer Aktion klicken, um sie zu ändern.
keys-shared = { $count ->
    [one] { $count } Aktion teilt Tasten mit einer anderen
   *[other] { $count } Aktionen teilen Tasten mit einer anderen
}
keys-press = Tasten drücken...
keys-of = Tasten von { $action }
    .tip = Klicken, dann die neuen Tasten drücken. Esc lässt sie, Entf nimmt sie weg
keys-also = auch: { $actions } (eine gewählte geht vor)
    .own = auch: { $actions } (diese wird ausgeführt)
keys-unknown-action = keys.own: keine Aktion heißt "{ $id }"
keys-unreadable = keys.own.{ $id }: "{ $keys }" ist keine Taste: erwartet wird etwa Z, F12, [ oder Ctrl+Shift+Z

## Search, radial menu, dragged settings, curves

search-heading = Aktionen suchen
search-nothing = nichts heißt so

radial-radius = Radius
radial-mirror = Spiegel x
radial-thickness = Wandstärke
radial-frame = Einpassen
radial-strength = Stärke
radial-carve = Abtragen

modal-radius = Radius { $value }: Klick behält ihn, Esc lässt ihn, wie er war
modal-strength = Stärke { $value }: Klick behält sie, Esc lässt sie, wie sie war

curve-note = Zeichnen oder Punkte setzen: sie lassen sich ändern, bevor der Pinsel folgt.
curve-points = { $count ->
    [one] { $count } Punkt
   *[other] { $count } Punkte
}
curve-draw = Kurve ausführen
    .tip = Der Pinsel folgt ihr in einem Schritt (Eingabe)
curve-remove = Punkt entfernen
    .tip = Entf, oder rechte Maustaste darauf
curve-discard = Verwerfen
    .tip = Nichts wird gezeichnet (Esc)

## The first lesson

lesson-demo = Die Vorführung läuft. Den Ton jederzeit berühren
lesson-line = { $hint } ({ $at } von { $all })
lesson-sculpt = Auf dem Ton drücken und ziehen
lesson-turn = Neben dem Ton ziehen, um ihn zu drehen; das Rad zoomt
lesson-smooth = Umschalt halten und über das Gemachte streichen: es wird glatt
lesson-carve = Strg halten und streichen: es trägt ab statt auf
lesson-undo = { $keys } nimmt den letzten Strich zurück
lesson-mirror = { $keys }, oder x unter Spiegel links, und ein Strich: beide Seiten
    .no-keys = Links unter Spiegel x wählen und einen Strich machen: beide Seiten

## Help

help-heading = Hilfe
help-pages = Seiten rechts
help-keys = Tasten
help-pen = Stift oder Maus
help-pen-press = Auf dem Ton drücken und ziehen
    .does = Formen
help-pen-carve = Dasselbe mit Strg oder Alt
    .does = Abtragen statt auftragen, für einen Strich
help-pen-smooth = Dasselbe mit Umschalt
    .does = Glätten, für einen Strich
help-pen-turn = Neben dem Ton ziehen, oder mit der rechten Taste
    .does = Die Ansicht drehen
help-pen-slide = Mittlere Taste, oder rechte mit Umschalt
    .does = Die Ansicht schieben
help-pen-zoom = Rad
    .does = Näher zu dem, was unter dem Zeiger ist
help-pen-menu = Leertaste halten
    .does = Menü um den Zeiger
help-fingers = Finger auf einem Bildschirm
help-fingers-one = Ein Finger auf dem Ton
    .does = Formen
help-fingers-two = Zwei Finger
    .does = Die Ansicht drehen; zusammengezogen zoomen sie
help-fingers-three = Drei Finger
    .does = Die Ansicht schieben (Seite Mehr tauscht beides)
help-fingers-tap = Tippen mit dreien, mit vieren
    .does = Rückgängig, Wiederholen
help-hands = Bloße Hände über einem Sensor
help-hands-index = Zeigefinger gestreckt
    .does = Die Fingerspitze drückt den Ton
help-hands-pinch = Daumen und Zeigefinger geschlossen
    .does = Ton halten, tragen, loslassen
help-hands-flat = Finger gestreckt und geschlossen
    .does = Die Handfläche drückt und glättet
help-hands-open = Finger gestreckt und gespreizt
    .does = Die Ansicht drehen; mit zwei Händen zoomen
help-hands-fist = Faust
    .does = Die Ansicht schieben
help-hands-both = Pinzettengriff mit beiden Händen
    .does = Die Skulptur halten: drehen, bewegen, skalieren
help-hands-menu = Eine Fingerspitze ruht in einer Kugel links
    .does = Aus dem Menü der Hände wählen
help-work = Die Arbeit bleibt erhalten
help-work-close = Das Fenster jederzeit schließen
    .does = Die Sitzung geht dort weiter, wo sie war
help-work-files = Seite Dateien
    .does = Öffnen, exportieren, frühere Skulpturen

## Actions

action-brush = Pinsel { $brush }
action-page = Seite: { $page }
action-undo = Rückgängig
action-redo = Wiederholen
action-carve = Abtragen oder auftragen
action-larger = Größerer Pinsel
action-smaller = Kleinerer Pinsel
action-stronger = Stärkerer Pinsel
action-weaker = Schwächerer Pinsel
action-drag-radius = Radius ziehen
action-drag-strength = Stärke ziehen
action-sample-colour = Farbe aufnehmen
action-mirror-x = Spiegeln über x
action-mirror-y = Spiegeln über y
action-mirror-z = Spiegeln über z
action-frame = Skulptur einpassen
action-front = Ansicht von vorn
action-back = Ansicht von hinten
action-left = Ansicht von links
action-right = Ansicht von rechts
action-top = Ansicht von oben
action-bottom = Ansicht von unten
action-perspective = Perspektivisch oder orthografisch
action-four-views = Vier Ansichten oder eine
action-next-material = Nächstes Material
action-facets = Glatte oder flache Schattierung
action-ssao = Umgebungsverdeckung
action-shadows = Schatten
action-wireframe = Drahtgitter
action-grid = Raster
action-thickness = Karte der Wandstärke
action-mask = Karte der Maske
action-distance = Karte der Abstände
action-trim-box = Mit Rahmen zuschneiden
action-trim-line = Mit Linie zuschneiden
action-region-lasso = Bereich mit Lasso
action-region-box = Bereich mit Rahmen
action-region-line = Bereich mit Linie
action-region-polyline = Bereich mit Polygon
action-region-mask = Bereich maskieren
action-region-unmask = Bereich freigeben
action-region-hide = Bereich verbergen
action-region-isolate = Nur einen Bereich zeigen
action-region-face-set = Flächengruppe aus Bereich
action-finer = Feinere Stufe
action-coarser = Gröbere Stufe
action-remesh = Remesh
action-try-add = Vorschau: gehaltenes Objekt vereinen
action-try-cut = Vorschau: mit gehaltenem Objekt schneiden
action-try-keep = Vorschau: Gemeinsames behalten
action-open-mesh = Ein Mesh öffnen
action-export = Das Mesh exportieren
action-screenshot = Bildschirmfoto
action-turntable = Bilder des Drehtellers
action-search = Aktionen suchen
action-panels = Felder
action-light-or-dark = Hell oder dunkel
action-larger-text = Größere Schrift
action-smaller-text = Kleinere Schrift
action-help = Hilfe
action-keys = Tasten ändern
action-lesson = Erste Lektion

## Messages of background tasks

task-loaded = { $name }: { $count } Punkte
task-exported = Gespeichert: { $path }: { $x } x { $y } x { $z } { $unit }
task-saved = Gespeichert: { $path }
task-frames = { $frames } Bilder gespeichert in { $folder }
task-failed = { $path }: { $error }
task-done = { $operation }: fertig
task-snapped = Die Flächen liegen aneinander
task-mirrored = Ein gespiegelter Zwilling ist da
task-trimmed = Zugeschnitten
task-level = Stufe { $at } von { $all }
task-remesh-local = Geänderte Kanten: { $count }
task-remesh-taken-back = Das neue Netz wurde zurückgenommen, bevor es fertig war.
task-remeshed = Remesh: { $count } Dreiecke, Voxel von { $voxel }, Volumen { $change } %; Durchdringungen: { $crossings }
task-remesh-lost = Teile, die dünner als ein Voxel sind, gingen verloren, zum Beispiel bei { $x }, { $y }, { $z }: rückgängig machen und einen kleineren Voxel wählen
task-quads = { $quads } Vierecke und { $triangles } Dreiecke; Durchdringungen: { $crossings }
task-decimated = Aus { $before } Dreiecken wurden { $now }; neue Durchdringungen: { $crossings }
task-layers-baked = In die neue Fläche eingerechnete Ebenen: { $count }
task-sets-made = Flächengruppen angelegt
task-mask-measured = Maskiert: { $count } Eckpunkte
task-sets-dropped = Die Flächengruppen gingen mit der alten Fläche; nichts ist mehr verborgen
task-extracted = Objekt mit { $count } Punkten herausgelöst
task-preferences-unreadable = { $path }: { $error }; sie liegt jetzt als { $aside }
task-preferences-stuck = { $path }: { $error }; sie lässt sich nicht beiseitelegen: { $why }
task-brush-saved = Der Pinsel { $name } ist gespeichert
task-brush-not-saved = Der Pinsel ist nicht gespeichert: { $error }
task-picture-kept = Behalten als { $path }
task-preferences-unread = { $path }: die Einstellungen lassen sich nicht lesen: { $error }
task-preferences-not-kept = { $path }: die Einstellungen sind nicht gespeichert: { $error }
language-unreadable = { $path }: { $error }

## People who share the sculpture

people-heading = Personen
people-you = { $name } (du)
people-gone = Gegangen: { $names }
people-sculptor = formt
people-viewer = schaut zu
people-device = Gerät
people-invite = Mit einem Code einladen
people-invite-about = Mit Telefon oder Tablet in diesem Netz scannen oder den Link öffnen: modelliert wird im Browser.
people-invite-copy = Link kopieren
undo-in-the-way = Nicht zurückgenommen: { $name } hat dieselbe Stelle seither verändert. Nimmt { $name } das zurück, geht es.
redo-in-the-way = Nicht wiederholt: { $name } hat dieselbe Stelle seither verändert. Nimmt { $name } das zurück, geht es.
