# What the window says in Italian; config/languages/en/window.ftl holds the English of every message.

language-name = Italiano
    .latin = Italiano

## Keys that are held with another one

key-ctrl = Ctrl
key-alt = Alt
key-shift = Maiusc

## Words that many places share

off = spento
none = nessuno
cancel = Annulla
reset = Ripristina
undo = Annulla
redo = Ripeti
open = Apri
export = Esporta
length-mm = { $value } mm
area-mm2 = { $value } mm²
volume-mm3 = { $value } mm³
time-ms = { $value } ms
percent = { $value } %
size-bytes = { $value } B
size-kilobytes = { $value } kB
size-megabytes = { $value } MB
triangles = { $count } triangoli
both-keys = { $first } e { $second }
name-with-keys = { $name } ({ $keys })

## Pages at the right

page-look = Vista
    .about = Come si vede l'argilla
page-scene = Scena
    .about = Un secondo oggetto, operazioni booleane, livelli di dettaglio, tagli
page-walls = Pareti
    .about = Spessore delle pareti e punti sottili
page-measure = Misure
    .about = Misure, ombra lungo una direzione, distanze da un'altra forma
page-files = File
    .about = Aprire, esportare, immagini
page-devices = Penne
    .about = Dispositivi e i loro valori dal vivo
page-loop = Ciclo
    .about = Tempi del ciclo di calcolo e di questa finestra
page-more = Altro
    .about = Lingua, preferenze e messaggi

## Brushes

kind-gaussian = Gaussiano
    .about = Alza una campana di argilla lungo la normale della superficie (Cipollini 2020).
kind-smooth = Liscia
    .about = Uniforma la superficie: laplaciano con pesi cotangenti; la forza è la parte del percorso compiuta in un tocco.
kind-draw = Disegna
    .about = Alza la superficie lungo la sua normale media, secondo l'attenuazione.
kind-clay = Argilla
    .about = Aggiunge argilla in uno strato piano: riempie fino a un piano poco sopra la superficie.
kind-clay-strips = Strisce argilla
    .about = Stende argilla in fasce piatte con estremità squadrate, orientate lungo il tratto.
kind-inflate = Gonfia
    .about = Gonfia la forma: ogni vertice lungo la propria normale.
kind-layer = Strato
    .about = Uno strato di altezza uniforme per tratto, per quante volte il tratto vi ripassi.
kind-crease = Piega
    .about = Incide un solco dai lati avvicinati; in negativo alza una cresta.
kind-pinch = Pizzica
    .about = Attira la superficie verso il centro del pennello; in negativo la allarga.
kind-blob = Goccia
    .about = Alza una goccia rotonda: la superficie si gonfia a partire da un punto sottostante.
kind-flatten = Appiattisci
    .about = Porta rilievi e cavità verso il piano medio; in negativo li accentua.
kind-fill = Riempi
    .about = Riempie le cavità fino al piano medio e lascia i rilievi; in negativo abbassa i rilievi.
kind-scrape = Raschia
    .about = Abbassa i rilievi fino al piano medio e lascia le cavità; in negativo riempie le cavità.
kind-trim = Rifila
    .about = Taglia ciò che sporge da un piano poco sotto la superficie, come un coltello.
kind-grab = Afferra
    .about = Ciò che era sotto il pennello quando la penna è scesa segue la penna.
kind-elastic = Elastico
    .about = Muove l'argilla come un corpo elastico tenuto in un punto (Kelvinlet regolarizzati, de Goes e James 2017).
kind-topological = Topologico
    .about = Come Afferra, ma prende ciò che è vicino lungo la superficie, non attraverso l'aria.
kind-snake-hook = Uncino
    .about = Tira l'argilla dietro la penna e la segue.
kind-twist = Torci
    .about = Ruota ciò che era sotto il pennello attorno alla normale quando la penna va verso destra.
kind-thumb = Pollice
    .about = Trascina lungo la superficie ciò che era sotto il pennello.
kind-nudge = Spingi
    .about = Spinge la superficie insieme al tratto.
kind-relax = Rilassa
    .about = Uniforma i triangoli lungo la superficie e lascia la forma.
kind-mask = Maschera
    .about = Protegge dagli altri pennelli ciò che dipinge; in negativo lo libera.
kind-mask-blur = Sfuma maschera
    .about = Ammorbidisce i bordi della maschera; in negativo li rende netti.
kind-paint = Colora
    .about = Stende sull'argilla il colore del pennello.
kind-texture = Texture
    .about = Imprime un alfa in rilievo lungo il tratto, piegato come il tratto e ripetuto.
kind-density = Densità
    .about = Porta i triangoli alla grandezza voluta, una parte del pennello, e li uniforma; la forma resta.
kind-simplify = Semplifica
    .about = Unisce i triangoli piccoli fino alla grandezza voluta, una parte del pennello; i grandi e la forma restano.
kind-slide-relax = Scorrimento
    .about = Fa scorrere i triangoli lungo la superficie con il tratto e lascia la forma; con Maiusc, o invertito, li rilassa.
kind-plane = Piano
    .about = Porta rilievi e cavità al piano medio della superficie come l'ha trovata il tratto; in negativo li accentua.
kind-multiplane-scrape = Raschia doppio
    .about = Raschia due piani che si incontrano lungo il tratto e lascia uno spigolo dai lati piatti.
kind-sharpen = Nitidezza
    .about = Fa risaltare i rilievi fini; in negativo li attenua.
kind-surface-smooth = Liscia superficie
    .about = Uniforma la superficie e ne conserva il volume (Taubin 1995).
kind-boundary = Bordo
    .about = Il bordo di una superficie aperta segue la penna, e con esso la superficie dietro.
kind-erase-layer = Cancella livello
    .about = Toglie ciò che fa il livello attivo; la superficie torna a ciò che sta sotto.
kind-draw-face-sets = Disegna insiemi
    .about = Disegna insiemi di facce: ogni tratto uno nuovo; in negativo continua l’insieme da cui parte.

## Numbers of single brushes

number-depth = profondità
    .blob = quanto sotto la superficie si trova quel punto, in raggi
    .plane = quanto lo strato scende sotto il piano, in raggi
    .trim = quanto sotto la superficie taglia, in raggi, a piena forza
number-lift = altezza del piano
    .about = quanto il piano sta sopra la superficie, in raggi, a piena forza
number-fill = riempimento
    .about = la parte del percorso verso il piano per un quinto di raggio percorso
number-roundness = rotondità
    .about = 0 un quadrato, 1 un disco
number-pinch = pizzico
    .about = quanto i lati vengono avvicinati
number-poisson = Poisson
    .about = quanto l'argilla conserva il volume: 0.5 del tutto
number-offset = scostamento
    .about = quanto il piano è spostato lungo la sua normale, in raggi
number-angle = angolo
    .about = tra le normali dei due piani, in gradi
number-height = altezza
    .about = quanto lo strato sale sopra il piano, in raggi
number-scale = scala
    .about = lunghezza di una ripetizione, in larghezze del pennello
number-floor = livello zero
    .about = l'altezza dell'alfa che resta sulla superficie; ciò che è più basso viene impresso
number-width = larghezza
    .about = larghezza dell'alfa in larghezze del pennello: sotto 1 si ripete, sopra 1 è ritagliato
number-set = insieme
    .about = numero dell’insieme che si disegna; 0: ogni tratto ne comincia uno nuovo

## The brush's settings

brush-more = Altri pennelli
brush-now = Pennello: { $name }
brush-favourites = Preferiti
brush-favourite = Preferito
    .tip = Sta per primo tra i pennelli
brush-own = I tuoi
    .tip = { $what } (di nuovo: come era salvato)
brush-own-about = { $kind }: { $about }
brush-radius = Raggio
    .tip = A piena pressione ({ $keys }, o { $drag } e trascinare)
brush-radius-pixels = Raggio in pixel
    .tip = Il pennello mantiene la sua misura sullo schermo durante lo zoom; spento: la sua misura sull'oggetto
brush-strength = Forza
    .tip = Quanto agisce un tocco ({ $keys }, oppure { $drag } e trascina)
brush-carve = Scava
    .tip = { $action }; tieni Ctrl per un solo tratto
brush-stroke = Tratto
brush-settings = Altre impostazioni
brush-dab = Forma del tocco
brush-stamp = Alfa e timbro
brush-automasks = Maschere automatiche
brush-topology = Topologia dinamica
brush-save = Salva questo pennello
    .tip = Sta tra i propri, con tutte le impostazioni e la sua immagine
brush-save-name = Nome
brush-save-new = Salva
brush-save-replace = Sostituisci
brush-save-wrong = Fino a 64 lettere, cifre, spazi, - e _, e nessun nome di un pennello del programma

stroke-spacing = Spaziatura
    .tip = Distanza tra i tocchi come parte del raggio
stroke-stabilizer = Stabilizza
    .tip = Il pennello segue la penna a questa distanza: una parte dell'altezza della vista
stroke-steadiness = Fermezza
    .tip = Lunghezza del filo con cui il pennello segue la penna, in raggi
stroke-average = Campioni mediati
    .tip = Il pennello va alla media di tanti campioni della penna
stroke-jitter = Dispersione
    .tip = Quanto i tocchi sono sparsi attorno al percorso, in raggi
stroke-seed = Seme della dispersione:
stroke-method = Metodo
stroke-continuous = Continua a penna ferma
stroke-ticks = Cicli tra i tocchi a penna ferma
stroke-compensate = Stessa forza con ogni spaziatura
    .tip = La forza conta lungo il percorso della penna; spento: ogni tocco la ha tutta
stroke-accumulate = Accumula
    .tip = Un tratto cresce su ciò che ha alzato esso stesso
stroke-limit = Limite del tratto
    .tip = Quanto un tratto può spostare un punto, in altezze di un tocco pieno; 0: senza limite

method-space = Spaziati
method-dots = Punti
method-airbrush = Aerografo
method-anchored = Ancorato
method-drag-dot = Punto trascinato
method-line = Linea
method-curve = Curva per punti

dab-falloff = Attenuazione
dab-curve-tip = A { $eighths } ottavi del raggio
dab-hardness = Durezza
    .tip = Parte del raggio in cui il pennello agisce del tutto
dab-smoothing = Lisciatura
    .tip = Ogni tocco viene lisciato con questa forza
dab-averaging = Media
    .tip = Parte del raggio su cui si calcola il piano medio della superficie
dab-plane-trim = Limite del piano
    .tip = Ciò che è più lontano dal piano resta, in raggi; 0: niente
dab-tilt = Inclinazione
    .tip = Quanto un tocco si inclina come la penna
dab-colour = Colore

colour-sample = Preleva
    .tip = { $action }: il prossimo clic sull'argilla ne prende il colore
colour-sample-here = Fare clic sul colore dell'argilla
colour-keep = Tieni
    .tip = D'ora in poi il colore sta qui sotto
colour-swatch = Colore { $code }
    .tip = { $code }: un clic lo prende, il tasto destro lo toglie
colour-nothing = Sotto il puntatore non c'è argilla

falloff-gaussian = Gaussiana
falloff-smooth = Morbida
falloff-sphere = Sfera
falloff-root = Radice
falloff-sharp = Netta
falloff-linear = Lineare
falloff-constant = Costante
falloff-custom = Personalizzata

stamp-alpha = Alfa
stamp-stamp = Timbro
stamp-size = Grandezza timbro
stamp-angle = Angolo timbro
stamp-repeat = Ripeti il timbro
stamp-right = Stencil a destra
stamp-up = Stencil in alto
stamp-at-tip = Dal centro della vista, in altezze della vista
stamp-off = Nessuno
stamp-dab = Sotto ogni tocco
stamp-view = Lungo la vista
stamp-stencil = Stencil

alpha-studs = Borchie
alpha-scales = Squame
alpha-rope = Corda
alpha-stitches = Cuciture
alpha-waves = Onde
alpha-bricks = Mattoni
alpha-stone = Pietra
alpha-cracks = Crepe
alpha-picture = Immagine caricata

automask-front = Solo facce anteriori
automask-topology = Solo parti connesse
automask-sets = Solo l’insieme del primo tocco
automask-boundary = I bordi restano
    .tip = Il bordo di una superficie aperta non si muove
automask-normal = Limite normale
    .tip = Solo ciò che devia dalla normale del tocco al massimo di questi gradi; 0: tutto
automask-cavity = Cavità
    .tip = Sopra 0 si toccano solo le cavità, sotto 0 solo le creste

topology-by = Lunghezza spigoli
topology-length = Lunghezza
topology-split = Dividi gli spigoli più lunghi
topology-collapse = Unisci gli spigoli più corti
topology-off = Spento
topology-brush = Parte del pennello
topology-object = Parte dell'oggetto
topology-view = Parte della vista

## Mirror, pressure, masks, history

mirror-heading = Specchio

pressure-heading = Pressione
pressure-curve = Curva di pressione
    .tip = Trascina l'estremo sinistro per il tocco più leggero, il centro per la curvatura
pressure-lightest = Minimo
pressure-bend = Curvatura
pressure-radius = Raggio
    .tip = Parte del raggio al tocco più leggero
pressure-radius-curve = Curva di pressione del raggio
pressure-radius-bend = Piega del raggio

mask-heading = Maschera
mask-clear = Azzera
    .tip = Tutto è libero
mask-fill = Riempi
    .tip = Tutto è protetto
mask-invert = Inverti
    .tip = Ciò che è libero è protetto, ciò che è protetto è libero
mask-blur = Sfuma
    .tip = Un bordo più morbido
mask-sharpen = Affila
    .tip = Un bordo più netto
mask-grow = Espandi
    .tip = Un anello di vertici in più
mask-shrink = Riduci
    .tip = Un anello in meno
mask-cavity = Cavità
    .tip = Le cavità sono protette
mask-thin = Parti sottili
    .tip = Ciò che ha al massimo questo spessore resta protetto
mask-occlusion = Riparato
    .tip = Ciò che l’oggetto tiene in ombra resta protetto
mask-thin-below = sottile è
    .tip = Quota del lato più lungo
mask-note = { $keys } la mostra; il pennello maschera la dipinge

history-heading = Cronologia
history-steps = { $at } di { $all }
history-versions = { $count ->
    [one] { $count } versione
   *[other] { $count } versioni
}
history-step = Passo
    .tip = Trascina per scorrere i passi
history-after = Dopo il passo { $step }
history-version = Versione
    .tip = Trascina per scorrere le versioni di questa linea
history-row = Versione { $node }, a { $time }
history-row-branch = Versione { $node }, a { $time }, su un ramo
history-replaced = sostituito
history-added = aggiunto
history-removed = rimosso
history-duplicated = duplicato
history-renamed = rinominato
history-moved = spostato
history-activated = attivato
history-shown = mostrato o nascosto
history-locked = bloccato o sbloccato
history-reshaped = rimodellato
history-boolean = booleana
history-merged = unito
history-split = diviso
history-layers = livelli
history-sets = insiemi di facce
history-mask = maschera
history-remesh = dimensione dei triangoli
history-snapped = messo a filo
history-arranged = riordinato
history-set-named = insieme nominato
history-followed = ha seguito gli operandi
history-applied = booleana applicata
history-mirrored = specchiato

## Page: look

look-material = Materiale
material-clay = argilla
material-porcelain = porcellana
material-wax = cera
material-stone = pietra
material-jade = giada
material-bronze = bronzo
material-graphite = grafite
material-steel = acciaio
light-name = Luce
    .tip = Le immagini dell'ambiente (HDR, EXR) e di sfere illuminate, quadrate, si conservano trascinandole sulla finestra
light-studio = Studio
light-room = Stanza
light-matcap = Sfera illuminata
light-turned = Rotazione
light-raised = Altezza
light-shadow = Ombre
    .tip = { $action }: ciò che sta nella luce principale scurisce ciò che è dietro
light-bright = Luminosità
reference-name = Riferimento
    .tip = Trascina sulla finestra un'immagine non quadrata
reference-none = Nessuno
reference-behind = Dietro l'argilla
reference-opacity = Opacità
look-facets = Sfaccettature
look-cavity = Cavità
    .tip = Cavità più scure, creste più chiare
look-occlusion = Occlusione
    .tip = { $action }: occlusione ambientale nello spazio dello schermo
look-wireframe = Fil di ferro
look-grid = Griglia
look-smooth-edges = Bordi morbidi
    .tip = Quattro campioni per pixel; costa tempo dove non disegna una scheda grafica
look-map = Mappa
map-none = Nessuna
    .tip = L'argilla stessa
map-mask = Maschera
map-thickness = Spessore
map-distance = Distanza
look-camera = Camera
look-orthographic = Ortografica
look-angle = Angolo
    .tip = Campo visivo, gradi
look-four-views = Quattro viste
view-top = Dall'alto
view-free = Libera
view-front = Di fronte
view-right = Da destra
view-alone = Mostra solo questa vista, come un doppio clic accanto all'argilla. «{ $action }» va e torna.
views-no-copies = Le quattro viste richiedono uno schermo su cui copiare immagini, che questo driver non offre. Si continua in una sola vista.
look-keep = Conserva la vista
    .tip = Conserva questa vista con un numero, per tornarci
    .show = Mostra di nuovo questa vista; un clic destro la dimentica
legend-measuring = misuro

## Page: scene

scene-object = Oggetto
scene-size = { $x } x { $y } x { $z } { $unit }
scene-held = Oggetto in mano
    .tip = Appare accanto all'oggetto, per esservi spostato dentro
scene-held-note = Prendi una forma, spostala al suo posto, poi aggiungi, taglia o tieni.
scene-add = Aggiungi
    .tip = I due diventano uno
scene-cut = Taglia
    .tip = Ciò che è in mano viene tagliato dall'oggetto
scene-keep = Interseca
    .tip = Resta solo ciò che è in entrambi
scene-put-down = Posa
    .tip = Diventa un oggetto dove si trova
scene-put-away = Metti via
scene-busy = calcolo in corso: continua a scolpire
scene-preview = Anteprima
scene-computing = calcolo ...
scene-shown = { $count } triangoli dell'oggetto in mano
scene-apply = Applica
    .tip = Fai ciò che è mostrato
scene-dismiss = Scarta
    .tip = L'oggetto resta com'è; anche quello in mano
scene-yaw = imbardata
scene-pitch = beccheggio
scene-roll = rollio
scene-scale = scala
scene-held-size = grandezza

objects-heading = Oggetti
objects-add = Aggiungi oggetto
objects-duplicate = Duplica
objects-rename = Rinomina
objects-remove = Rimuovi
objects-locked = Bloccato: né tratti, né spostamenti, né rimozione
objects-group = Gruppo
    .tip = Dà un nome al gruppo dell’oggetto; un nome vuoto lo toglie
objects-mirror = Specchia
objects-live = Booleane vive
    .tip = Gli operandi restano nascosti e il risultato si ricalcola quando uno cambia
objects-follows = Segue i suoi operandi
objects-apply = Applica
    .tip = Gli operandi spariscono e il risultato resta com’è
objects-gizmo = Gizmo
    .tip = Sposta, ruota e scala l’oggetto con il puntatore; con Ctrl a passi
objects-snap = Accosta faccia a faccia
    .tip = Mette una faccia piana di un oggetto a filo con quella di un altro
objects-snap-first = Premi sulla faccia da spostare
objects-snap-second = Premi sulla faccia a cui accostarla
objects-eye = vedi
    .tip = Disegnato
objects-lock = blocca
    .tip = Protetto da tratti, spostamenti e rimozione
objects-reset-place = Azzera posizione
    .tip = Torna dove è stato creato
shape-box = Cubo
shape-ball = Sfera
shape-cylinder = Cilindro
shape-cone = Cono
shape-torus = Toro
shape-tube = Tubo
shape-plane = Piano
operation-all = Tutti e quattro
    .tip = Unione, intersezione e le due differenze, ognuna un oggetto
operation-union = Unione
    .tip = L'oggetto attivo e questo diventano uno
operation-intersection = Intersezione
    .tip = Resta solo ciò che è in entrambi
operation-difference = Differenza
    .tip = Questo oggetto viene tagliato da quello attivo
operation-reverse-difference = Differenza inversa
    .tip = Quello attivo viene tagliato da questo

sets-heading = Insiemi di facce
sets-eye-tip = Mostra o nascondi l’insieme
sets-colours = Mostra a colori
sets-isolate = solo
    .tip = Nasconde tutto tranne questo insieme
sets-draw = disegna
    .tip = Prende il pennello che disegna questo insieme
sets-none = in nessun insieme: { $count }
sets-row = insieme { $number }: { $count }
sets-hide-masked = Nascondi mascherato
    .tip = Nasconde ciò che è mascherato almeno a metà
sets-invert = Inverti visibile
    .tip = Nasconde il visibile e mostra il nascosto
sets-show-all = Mostra tutto
    .tip = Niente è più nascosto
sets-clear = Svuota insiemi
    .tip = Nessun vertice è più in un insieme; il nascosto resta nascosto
sets-from-mask = Dalla maschera
    .tip = Ciò che è mascherato almeno a metà diventa un insieme
sets-from-visible = Dal visibile
    .tip = Tutto il visibile diventa un insieme
sets-loose = Parti separate
    .tip = Ogni parte connessa diventa un insieme
sets-normals = Per direzione
    .tip = Ogni parte rivolta circa da un lato diventa un insieme
sets-crease = Per pieghe
    .tip = Gli insiemi si toccano dove la superficie piega più dell’angolo
sets-degrees = Angolo
sets-thickness = Spessore
    .tip = Parte del lato più lungo; sotto 0 verso l’interno
sets-extract-mask = Estrai maschera
    .tip = Ciò che è mascherato diventa un oggetto: un guscio chiuso di questo spessore
sets-extract-name = estratto

layers-heading = Livelli di scultura
layers-add = Aggiungi livello
    .tip = I tratti vanno sul nuovo livello
layers-name = livello { $number }
layers-base = base
    .tip = I tratti restano sotto tutti i livelli
layers-unseen = Il livello attivo è nascosto o la sua intensità è 0: i tratti non si vedrebbero
layers-topology = La topologia dinamica riposa finché l'oggetto ha livelli; consolidali per usarla
layers-eye = vedi
    .tip = Visibile
layers-up = Su
    .tip = Sopra il livello successivo
layers-down = Giù
    .tip = Sotto il livello successivo
layers-merge = Unisci in basso
    .tip = Lo aggiunge al livello sottostante, o alla base. Entrambi devono essere visibili
layers-duplicate = Duplica livello
    .tip = Un gemello nascosto sopra di esso
layers-clear = Svuota livello
    .tip = Toglie ciò che fa
layers-remove = Rimuovi livello
    .tip = Lo rimuove con ciò che fa
layers-rename = Rinomina livello
layers-bake = Consolida livelli
    .tip = La superficie com'è diventa la base

levels-heading = Livelli
levels-at = livello { $at } di { $all }, { $count } triangoli
levels-coarser = Più rado
    .tip = Modella l'insieme; il dettaglio dei livelli fini segue
levels-finer = Più fine
    .tip = Quattro triangoli per ciascuno
    .back = Torna al livello più fine

remesh-heading = Remesh
remesh-own = Voxel su misura
    .tip = Altrimenti i nuovi triangoli sono grandi circa come quelli attuali
remesh-voxel = voxel
remesh-along = { $count } lungo il lato maggiore
remesh-sharp = Conserva gli spigoli vivi
remesh-button = Remesh
    .tip = Una superficie di triangoli uniformi; le parti sovrapposte diventano una. { $keys }
remesh-local-heading = Sul posto
remesh-local-edge = Lunghezza degli spigoli
    .tip = Volte la lunghezza abituale degli spigoli dell’oggetto
remesh-local-undo = { $keys } lo annulla in ogni momento, anche mentre è in corso.
remesh-stretched = Affina ciò che è stirato
    .tip = Divide gli spigoli troppo lunghi di tutto l’oggetto; ciò che è mascherato o nascosto resta

quads-heading = Quadrilateri
quads-count = quadrilateri
quads-levels = livelli più fini
    .tip = I quadrilateri sono il livello più basso; i livelli più fini riportano il dettaglio
quads-button = Remesh in quadrilateri
    .tip = Quadrilateri che seguono la forma; un'esportazione senza livelli li scrive

decimate-heading = Decimazione
decimate-share = dei triangoli
decimate-button = Decima
    .tip = Meno triangoli, per la stampa e il web. Nessuna nuova autointersezione, e il bordo della maschera resta

trim-heading = Taglio
trim-box = Riquadro
    .tip = Trascina un riquadro sulla vista: ciò che vi cade viene tagliato, da parte a parte
trim-line = Linea
    .tip = Trascina una linea sulla vista: ciò che sta alla sua sinistra viene tagliato
trim-note = Trascina sulla vista; Esc annulla.

region-heading = Regione della vista
region-draw = Regione:
region-lasso = Lazo
    .tip = Trascina attorno a ciò che intendi
region-box = Riquadro
    .tip = Trascina da angolo ad angolo
region-line = Linea
    .tip = Trascina una linea: conta ciò che sta alla sua sinistra
region-polyline = Polilinea
    .tip = Premi angolo per angolo
region-front = Solo facce anteriori
    .tip = Solo ciò che guarda verso di te; altrimenti da parte a parte
region-mask = Maschera
    .tip = Protegge ciò che è nella regione; con Ctrl: lo libera
region-unmask = Smaschera
    .tip = Libera ciò che è nella regione; con Ctrl: lo protegge
region-hide = Nascondi
    .tip = Nasconde ciò che è nella regione; con Ctrl: tutto il resto
region-isolate = Mostra solo
    .tip = Nasconde tutto il resto; con Ctrl: ciò che è nella regione
region-face-set = Insieme
    .tip = Ciò che è nella regione diventa un nuovo insieme
region-remesh = Dimensione dei triangoli
    .tip = I triangoli nella regione ricevono questa lunghezza, attraverso tutto l’oggetto
region-done = Fine
    .tip = Finisce di disegnare regioni (Esc)
region-note = Trascina sulla vista. Ctrl inverte, Esc termina.
region-polyline-note = Premi ogni angolo; di nuovo il primo o l’ultimo, o Invio, la chiude.

menu-add = aggiungi
menu-carve = scava
menu-keep = tieni il comune
menu-put-away = metti via
menu-ball = sfera
menu-box = cubo
menu-cylinder = cilindro
menu-undo = annulla
menu-redo = ripeti
menu-pick-up = prendi

## Page: walls

walls-heading = Spessore delle pareti
walls-live = Mappa dal vivo
walls-process = Processo
walls-own-limit = limite proprio
walls-too-thin-below = Troppo sottile sotto
walls-note = Premi { $keys }: la mappa segue l'argilla mentre scolpisci.
walls-thinnest = minimo
walls-median = mediana
walls-thickest = massimo
walls-too-thin = sottile
walls-measured = misurato
walls-spots = Punti sottili
walls-none = Nessuno sotto il limite.
walls-spot = { $number }: { $value } mm
    .tip = La camera vi si porta
walls-histogram = Istogramma dello spessore
    .tip = Da { $min } a { $max } mm; la linea è il limite
process-abs = Stampaggio a iniezione, ABS
process-fdm = Filamento fuso (FDM)
process-pa = Stampaggio a iniezione, poliammide (PA)
process-pc = Stampaggio a iniezione, policarbonato (PC)
process-pom = Stampaggio a iniezione, acetalica (POM)
process-pp = Stampaggio a iniezione, polipropilene (PP)
process-sla = Stereolitografia (SLA)
process-sls = Sinterizzazione laser (SLS)

## Page: size

measure-heading = Misure
measure-waits = Si misura quando nulla cambia.
measure-volume = volume
measure-area = area
measure-size = lato { $axis }
measure-shadow = ombra { $axis }
measure-stale = Di uno stato precedente; si rimisura quando nulla cambia.
shadow-heading = Ombra
shadow-along = ombra lungo { $axis }
    .tip = Vista lungo { $axis }
shadow-here = Da qui
    .tip = Vista come la vede la camera
shadow-size = { $x } x { $y } mm, { $holes } fori
shadow-file = Disegno da scrivere
    .tip = Il file del disegno
shadow-write = SVG
    .tip = Il contorno come disegno in scala, millimetri
shadow-outline = Contorno dell'ombra
distance-heading = Distanza
distance-live = Mappa delle distanze
distance-before = da prima
    .tip = Dall'oggetto com'era quando è stato aperto
distance-held = dall'oggetto in mano
distance-now = Confronta con adesso
    .tip = Le distanze si misurano dall'oggetto com'è adesso
distance-note = Blu è dentro, rosso fuori.
distance-deepest = più fondo
distance-highest = più alto
distance-rms = rms
distance-known = noto

## Page: files

files-open = Apri
    .note = Trascina una mesh sulla finestra, oppure:
files-open-name = File da aprire
files-browse = Sfoglia...
files-recent = Recenti
files-earlier = Sculture precedenti
files-export = Esporta
files-export-name = File da scrivere
files-scale = Scala
files-unit = Unità
unit-pixel = px
unit-mm = mm
unit-cm = cm
unit-m = m
unit-inch = pollici
files-save-as = Salva come...
files-pictures = Immagini
files-screenshot = Schermata
files-turntable = Giro completo
files-frames = fotogrammi
files-replace = Sostituisci
    .question = { $path } esiste già. Sostituirlo?

chooser-open = Apri una mesh
chooser-export = Esporta la scultura
chooser-meshes = Mesh
chooser-home = Home
chooser-documents = Documenti
chooser-downloads = Scaricati
chooser-desktop = Scrivania
chooser-up = Su
chooser-reading = lettura...
chooser-empty = qui non ci sono cartelle né file di mesh
chooser-name = Nome

start-heading = Continua con
start-note = Questa nuova scultura viene salvata mentre lavori.
start-stay = Resta qui
start-session = { $object }, { $date } { $time }

## Page: pens

devices-heading = Dispositivi
devices-none = Nessuna tavoletta trovata: collegane una, non serve riavviare.
    .mouse = Anche il mouse scolpisce: i tratti lenti premono di più.
devices-camera = Fotocamera
    .privacy = Le immagini restano in questo programma e non vengono salvate.
devices-in-range = Ora in portata
devices-pointer = puntatore
devices-tablet = tavoletta { $number }
devices-serial = penna seriale { $number }
devices-recording = registrazione { $number }
devices-demo = penna demo { $number }
devices-pen = penna { $number }
devices-eraser = { $pen }, gomma
devices-no-tilt = senza inclinazione
devices-tilt = inclinazione { $x }, { $y } gradi
devices-pressure = pressione { $pressure }, { $tilt }
devices-place = a { $x } %, { $y } % della vista
devices-hands = { $count ->
    [one] una mano rilevata
   *[other] { $count } mani rilevate
}
devices-strain = sforzo del braccio { $percent } %
devices-rest = Il braccio lavora in alto: riposalo, o lavora più in basso.
devices-nothing = niente
devices-curve = La curva di pressione a sinistra mostra la traccia dal vivo della penna.
pose-neutral = Neutra
pose-point = Indice
pose-pinch = Pizzico
pose-grab = Pugno
pose-flat = Piatta
pose-open = Aperta

tablet-heading = Tasti della tavoletta
tablet-choose = Scegli premendolo
    .tip = Poi premi il tasto della tavoletta o il pulsante della penna, o gira l'anello. Intanto non fa altro
tablet-listening = Premi ora un tasto...
tablet-usual = Come al solito ({ $action })
tablet-action = Azione di { $control }
tablet-line = { $control }: { $action }
tablet-reset = Ripristina
    .tip = Di nuovo come al solito
tablet-none = Tutto fa ciò che fa di solito.
tablet-nothing = Niente
tablet-next-mode = Modo successivo
tablet-radius = Raggio
    .back = Raggio, al contrario
tablet-strength = Forza
    .back = Forza, al contrario
tablet-turn = Ruota la vista finché premuto
tablet-slide = Sposta la vista finché premuto
tablet-zoom = Zoom finché premuto
tablet-radius-and-strength = Raggio e forza trascinando
tablet-carve = Scava finché premuto
tablet-brush = Pennello { $brush }
    .held = Pennello { $brush } finché premuto
control-key = Tasto { $number }
control-barrel = Pulsante { $number }
control-eraser = Gomma
control-wheel = Rotella { $number }
control-ring = Anello { $number }
control-strip = Striscia { $number }

## Page: loop

loop-heading = Ciclo
loop-tick = ciclo
loop-late = in ritardo
loop-samples = campioni
loop-dabs = tocchi
loop-lost = persi
    .note = persi: moto + contatti
loop-window = Questa finestra
loop-frames = quadri/s
loop-frame = quadro
loop-worst = peggiore
loop-to-clay = all'argilla
loop-to-screen = a schermo
    .note = all'argilla, a schermo: dall'ultimo campione
loop-in-view = in vista
loop-of = { $part } di { $all }
loop-uploaded = caricati
loop-object = Oggetto
loop-vertices = vertici
loop-triangles = triangoli
loop-saved = salvato mentre lavori: { $path }
loop-sample-to-screen = Dal campione allo schermo
loop-up-to = fino a { $value } ms
loop-longer = di più
loop-class = { $class }: { $count }
loop-histogram = { $frames } quadri; { $first } ms, e il doppio a ogni barra
stage-tick = ciclo
    .about = dalla lettura alla fine del ciclo che l'ha preso
stage-wait = attesa
    .about = dalla fine di quel ciclo all'inizio di un quadro
stage-draw = disegno
    .about = dall'inizio del quadro alla consegna dell'immagine
stage-present = mostra
    .about = dalla consegna alla presentazione
stage-total = totale
    .about = dalla lettura alla presentazione

## Page: more

preferences-heading = Preferenze
preferences-language = Lingua
preferences-language-system = Del sistema ({ $name })
preferences-font = { $name } richiede un carattere che manca su questo computer. Installane uno con le sue lettere, come Noto Sans CJK, e scegli di nuovo la lingua.
preferences-text-size = Testo
preferences-light = Pannelli chiari
preferences-speed = La velocità è pressione
    .tip = Per un mouse: i tratti lenti premono più di quelli veloci
preferences-lead = Mostra il tratto in anticipo sulla penna
    .tip = Ciò che la penna solleverà finché l’immagine si vede; la creta stessa dipende solo dalla penna
preferences-fingers = Due dita
    .tip = Su uno schermo tattile. Pizzicando fanno zoom; tre dita fanno l'altra cosa, tre tocchi annullano, quattro ripetono
preferences-fingers-turn = Ruota
preferences-fingers-slide = Sposta
preferences-lesson-skip = Salta la lezione
preferences-lesson-again = Ripeti la prima lezione
preferences-keys = Tasti...
preferences-help = Aiuto
preferences-search = Cerca azioni
preferences-no-session = Nessun file di sessione: la scultura si conserva solo se la esporti.

messages-heading = Messaggi
messages-loading = Carico { $name }

## The window of the keys

keys-heading = Tasti
keys-set = Insieme
keys-as-in-set = Come nell'insieme
    .tip = Dimentica ogni tasto che hai cambiato
keys-find = Trova
keys-note = Fai clic sui tasti di un'azione per cambiarli.
keys-shared = { $count ->
    [one] { $count } azione condivide i tasti con un'altra
   *[other] { $count } azioni condividono i tasti con un'altra
}
keys-press = Premi i tasti...
keys-of = Tasti di { $action }
    .tip = Fai clic, poi premi i nuovi tasti. Esc li lascia, Canc li toglie
keys-also = anche: { $actions } (prevale quella scelta)
    .own = anche: { $actions } (si esegue questa)
keys-unknown-action = keys.own: nessuna azione si chiama "{ $id }"
keys-unreadable = keys.own.{ $id }: "{ $keys }" non è un tasto: ci si aspetta ad esempio Z, F12, [ o Ctrl+Shift+Z

## Search, radial menu, dragged settings, curves

search-heading = Cerca azioni
search-nothing = niente si chiama così

radial-radius = Raggio
radial-mirror = Specchio x
radial-thickness = Spessore
radial-frame = Inquadra
radial-strength = Forza
radial-carve = Scava

modal-radius = Raggio { $value }: clic per tenerlo, Esc per lasciarlo com'era
modal-strength = Forza { $value }: clic per tenerla, Esc per lasciarla com'era

curve-note = Disegna, o metti punti: si possono cambiare prima che il pennello li segua.
curve-points = { $count ->
    [one] { $count } punto
   *[other] { $count } punti
}
curve-draw = Traccia la curva
    .tip = Il pennello la segue, in un solo passo (Invio)
curve-remove = Togli il punto
    .tip = Canc, o il tasto destro su di esso
curve-discard = Scarta
    .tip = Non si traccia niente (Esc)

## The first lesson

lesson-demo = La dimostrazione è in corso. Tocca l'argilla quando vuoi
lesson-line = { $hint } ({ $at } di { $all })
lesson-sculpt = Premi e trascina sull'argilla
lesson-turn = Trascina accanto all'argilla per ruotarla, usa la rotella per lo zoom
lesson-smooth = Tieni Maiusc e ripassa su ciò che hai fatto: diventa liscio
lesson-carve = Tieni Ctrl e traccia: scava invece di alzare
lesson-undo = { $keys } annulla l'ultimo tratto
lesson-mirror = { $keys }, o x in Specchio a sinistra, e un tratto: entrambi i lati
    .no-keys = Scegli x in Specchio a sinistra e fai un tratto: entrambi i lati

## Help

help-heading = Aiuto
help-pages = Pagine a destra
help-keys = Tasti
help-pen = Penna o mouse
help-pen-press = Premere e trascinare sull'argilla
    .does = Scolpire
help-pen-carve = Lo stesso con Ctrl o Alt
    .does = Scavare invece di alzare, per un tratto
help-pen-smooth = Lo stesso con Maiusc
    .does = Lisciare, per un tratto
help-pen-turn = Trascinare accanto all'argilla, o con il tasto destro
    .does = Ruotare la vista
help-pen-slide = Tasto centrale, o destro con Maiusc
    .does = Spostare la vista
help-pen-zoom = Rotella
    .does = Avvicinarsi a ciò che è sotto il puntatore
help-pen-menu = Tenere la barra spaziatrice
    .does = Menu attorno al puntatore
help-fingers = Dita su uno schermo
help-fingers-one = Un dito sull'argilla
    .does = Scolpire
help-fingers-two = Due dita
    .does = Ruotare la vista; pizzicando fanno zoom
help-fingers-three = Tre dita
    .does = Spostare la vista (la pagina Altro scambia i due)
help-fingers-tap = Tocco con tre, con quattro
    .does = Annulla, ripeti
help-hands = A mani nude sopra un sensore
help-hands-index = Indice teso
    .does = La punta del dito spinge l'argilla
help-hands-pinch = Pollice e indice chiusi
    .does = Prendere argilla, portarla, lasciarla
help-hands-flat = Dita tese e unite
    .does = Il palmo preme e liscia
help-hands-open = Dita tese e aperte
    .does = Ruotare la vista; con due mani zoom
help-hands-fist = Pugno
    .does = Spostare la vista
help-hands-both = Pizzicare con due mani
    .does = Tenere la scultura: ruotarla, spostarla, scalarla
help-hands-menu = Un dito fermo in una sfera a sinistra
    .does = Scegliere dal menu delle mani
help-work = Il lavoro si conserva
help-work-close = Chiudere la finestra quando si vuole
    .does = La sessione riprende da dove era
help-work-files = Pagina File
    .does = Aprire, esportare, sculture precedenti

## Actions

action-brush = Pennello { $brush }
action-page = Pagina: { $page }
action-undo = Annulla
action-redo = Ripeti
action-carve = Scava o alza
action-larger = Pennello più grande
action-smaller = Pennello più piccolo
action-stronger = Pennello più forte
action-weaker = Pennello più debole
action-drag-radius = Trascina il raggio
action-drag-strength = Trascina la forza
action-sample-colour = Preleva il colore
action-mirror-x = Specchio su x
action-mirror-y = Specchio su y
action-mirror-z = Specchio su z
action-frame = Inquadra la scultura
action-front = Vista frontale
action-back = Vista da dietro
action-left = Vista da sinistra
action-right = Vista da destra
action-top = Vista dall'alto
action-bottom = Vista dal basso
action-perspective = Prospettiva o ortografica
action-four-views = Quattro viste o una
action-next-material = Materiale successivo
action-facets = Ombreggiatura liscia o piatta
action-ssao = Occlusione ambientale
action-shadows = Ombre
action-wireframe = Fil di ferro
action-grid = Griglia
action-thickness = Mappa dello spessore
action-mask = Mappa della maschera
action-distance = Mappa delle distanze
action-trim-box = Taglia con un riquadro
action-trim-line = Taglia con una linea
action-region-lasso = Regione con lazo
action-region-box = Regione con un riquadro
action-region-line = Regione con una linea
action-region-polyline = Regione con polilinea
action-region-mask = Maschera una regione
action-region-unmask = Smaschera una regione
action-region-hide = Nascondi una regione
action-region-isolate = Mostra solo una regione
action-region-face-set = Insieme da una regione
action-finer = Livello più fine
action-coarser = Livello più rado
action-remesh = Remesh
action-try-add = Anteprima: aggiungi l'oggetto in mano
action-try-cut = Anteprima: taglia con l'oggetto in mano
action-try-keep = Anteprima: tieni il comune
action-open-mesh = Apri una mesh
action-export = Esporta la mesh
action-screenshot = Schermata
action-turntable = Fotogrammi del giro completo
action-search = Cerca azioni
action-panels = Pannelli
action-light-or-dark = Chiaro o scuro
action-larger-text = Testo più grande
action-smaller-text = Testo più piccolo
action-help = Aiuto
action-keys = Cambia i tasti
action-lesson = Prima lezione

## Messages of background tasks

task-loaded = { $name }: { $count } vertici
task-exported = Salvato { $path }: { $x } x { $y } x { $z } { $unit }
task-saved = Salvato { $path }
task-frames = Salvati { $frames } fotogrammi in { $folder }
task-failed = { $path }: { $error }
task-done = { $operation }: fatto
task-snapped = Le facce combaciano
task-mirrored = Aggiunto un gemello specchiato
task-trimmed = Tagliato
task-level = Livello { $at } di { $all }
task-remesh-local = Spigoli cambiati: { $count }
task-remesh-taken-back = Il rifacimento della maglia è stato annullato prima della fine.
task-remeshed = Remesh: { $count } triangoli, voxel di { $voxel }, volume { $change } %; intersezioni: { $crossings }
task-remesh-lost = Parti più sottili di un voxel sono andate perse, per esempio in { $x }, { $y }, { $z }: annulla e usa un voxel più piccolo
task-quads = { $quads } quadrilateri e { $triangles } triangoli; intersezioni: { $crossings }
task-decimated = { $before } triangoli sono diventati { $now }; nuove intersezioni: { $crossings }
task-layers-baked = Livelli consolidati nella nuova superficie: { $count }
task-sets-made = Insiemi di facce creati
task-mask-measured = Mascherati: { $count } vertici
task-sets-dropped = Gli insiemi di facce sono andati con la vecchia superficie; niente è più nascosto
task-extracted = Estratto un oggetto di { $count } vertici
task-preferences-unreadable = { $path }: { $error }; è conservato come { $aside }
task-preferences-stuck = { $path }: { $error }; non si può mettere da parte: { $why }
task-brush-saved = Il pennello { $name } è salvato
task-brush-not-saved = Il pennello non è salvato: { $error }
task-picture-kept = Conservata come { $path }
task-preferences-unread = { $path }: le preferenze non si possono leggere: { $error }
task-preferences-not-kept = { $path }: le preferenze non sono salvate: { $error }
language-unreadable = { $path }: { $error }

## People who share the sculpture

people-heading = Persone
people-you = { $name } (tu)
people-gone = Andati via: { $names }
people-sculptor = scultore
people-viewer = spettatore
people-device = dispositivo
people-invite = Invita con un codice
people-invite-about = Scansionalo con un telefono o tablet di questa rete, o apri il link: si scolpisce nel browser.
people-invite-copy = Copia il link
undo-in-the-way = Non annullato: { $name } ha poi cambiato lo stesso punto. Si potrà quando { $name } lo avrà annullato.
redo-in-the-way = Non ripetuto: { $name } ha poi cambiato lo stesso punto. Si potrà quando { $name } lo avrà annullato.
