# What the window says in Spanish; config/languages/en/window.ftl holds the English of every message.

language-name = Español
    .latin = Español

## Keys that are held with another one

key-ctrl = Ctrl
key-alt = Alt
key-shift = Mayús

## Words that many places share

off = no
none = ninguno
cancel = Cancelar
reset = Restablecer
undo = Deshacer
redo = Rehacer
open = Abrir
export = Exportar
length-mm = { $value } mm
area-mm2 = { $value } mm²
volume-mm3 = { $value } mm³
time-ms = { $value } ms
percent = { $value } %
size-bytes = { $value } B
size-kilobytes = { $value } kB
size-megabytes = { $value } MB
triangles = { $count } triángulos
both-keys = { $first } y { $second }
name-with-keys = { $name } ({ $keys })

## Pages at the right

page-look = Vista
    .about = Cómo se ve la arcilla
page-scene = Escena
    .about = Un segundo objeto, operaciones booleanas, niveles de detalle, recortes
page-walls = Paredes
    .about = Grosor de las paredes y puntos finos
page-measure = Medidas
    .about = Medidas, sombra en una dirección, distancias a otra forma
page-files = Archivos
    .about = Abrir, exportar, imágenes
page-devices = Lápices
    .about = Dispositivos y sus valores en vivo
page-loop = Ciclo
    .about = Tiempos del ciclo de cálculo y de esta ventana
page-more = Más
    .about = Idioma, preferencias y mensajes

## Brushes

kind-gaussian = Gaussiano
    .about = Levanta una campana de arcilla según la normal de la superficie (Cipollini 2020).
kind-smooth = Suavizar
    .about = Iguala la superficie: laplaciano con pesos de cotangente; la fuerza es la parte del camino en un toque.
kind-draw = Dibujar
    .about = Levanta la superficie según su normal media, conforme al decaimiento.
kind-clay = Arcilla
    .about = Añade arcilla en una capa plana: rellena hasta un plano algo por encima de la superficie.
kind-clay-strips = Tiras de arcilla
    .about = Pone arcilla en bandas planas de extremos cuadrados, orientadas según el trazo.
kind-inflate = Inflar
    .about = Hincha la forma: cada vértice según su propia normal.
kind-layer = Capa
    .about = Una capa de altura uniforme por trazo, por muchas veces que pase.
kind-crease = Pliegue
    .about = Graba un surco cuyos lados se acercan; en negativo levanta una arista.
kind-pinch = Pellizcar
    .about = Atrae la superficie al centro del pincel; en negativo la extiende.
kind-blob = Gota
    .about = Levanta una gota redonda: la superficie se hincha desde un punto debajo de ella.
kind-flatten = Aplanar
    .about = Lleva montes y huecos al plano medio; en negativo los acentúa.
kind-fill = Rellenar
    .about = Rellena huecos hasta el plano medio y deja los montes; en negativo rebaja los montes.
kind-scrape = Raspar
    .about = Rebaja montes hasta el plano medio y deja los huecos; en negativo rellena los huecos.
kind-trim = Recortar
    .about = Corta lo que sobresale de un plano algo por debajo de la superficie, como un cuchillo.
kind-grab = Agarrar
    .about = Lo que estaba bajo el pincel al bajar el lápiz sigue al lápiz.
kind-elastic = Elástico
    .about = Mueve la arcilla como un cuerpo elástico sujeto en un punto (Kelvinlets regularizados, de Goes y James 2017).
kind-topological = Topológico
    .about = Como agarrar, pero sujeta lo que está cerca por la superficie, no por el aire.
kind-snake-hook = Gancho
    .about = Saca arcilla tras el lápiz y va con ella.
kind-twist = Retorcer
    .about = Gira lo que estaba bajo el pincel en torno a la normal cuando el lápiz va a la derecha.
kind-thumb = Pulgar
    .about = Arrastra por la superficie lo que estaba bajo el pincel.
kind-nudge = Empujar
    .about = Empuja la superficie con el trazo.
kind-relax = Relajar
    .about = Iguala los triángulos por la superficie y deja la forma.
kind-mask = Máscara
    .about = Protege de otros pinceles lo que pinta; en negativo lo libera.
kind-mask-blur = Difuminar
    .about = Ablanda los bordes de la máscara; en negativo los endurece.
kind-paint = Pintar
    .about = Pone el color del pincel en la arcilla.
kind-texture = Textura
    .about = Imprime un alfa en relieve a lo largo del trazo, doblado como él y repetido.
kind-density = Densidad
    .about = Lleva los triángulos al tamaño deseado, una parte del pincel, y los iguala; la forma queda.
kind-simplify = Simplificar
    .about = Une triángulos pequeños hasta el tamaño deseado, una parte del pincel; los grandes y la forma quedan.
kind-slide-relax = Deslizar
    .about = Desliza los triángulos por la superficie con el trazo y deja la forma; con Mayús, o invertido, los relaja.
kind-plane = Plano
    .about = Lleva montes y huecos al plano medio de la superficie como la halló el trazo; en negativo los acentúa.
kind-multiplane-scrape = Raspado doble
    .about = Raspa dos planos que se encuentran a lo largo del trazo y deja una arista de lados planos.
kind-sharpen = Enfocar
    .about = Resalta el relieve fino; en negativo lo rebaja.
kind-surface-smooth = Alisar
    .about = Iguala la superficie y conserva su volumen (Taubin 1995).
kind-boundary = Borde
    .about = El borde de una superficie abierta sigue al lápiz, y la superficie tras él.
kind-erase-layer = Borrar capa
    .about = Quita lo que hace la capa activa; la superficie vuelve a lo que hay debajo.
kind-draw-face-sets = Dibujar conjuntos
    .about = Dibuja conjuntos de caras: cada trazo uno nuevo; en negativo sigue el conjunto donde empezó.

## Numbers of single brushes

number-depth = profundidad
    .blob = cuánto por debajo de la superficie está ese punto, en radios
    .plane = cuánto por debajo del plano llega la franja, en radios
    .trim = cuánto por debajo de la superficie corta, en radios, a plena fuerza
number-lift = elevación
    .about = cuánto por encima de la superficie está el plano, en radios, a plena fuerza
number-fill = relleno
    .about = la parte del camino al plano por cada quinto de radio recorrido
number-roundness = redondez
    .about = 0 un cuadrado, 1 un disco
number-pinch = pellizco
    .about = cuánto se acercan los lados
number-poisson = Poisson
    .about = cuánto conserva la arcilla su volumen: 0.5 del todo
number-offset = desfase
    .about = cuánto se mueve el plano según su normal, en radios
number-angle = ángulo
    .about = entre las normales de los planos, en grados
number-height = altura
    .about = cuánto por encima del plano llega la franja, en radios
number-scale = escala
    .about = longitud de una repetición, en anchos del pincel
number-floor = nivel cero
    .about = la altura del alfa que queda en la superficie; lo más bajo se hunde
number-width = ancho
    .about = ancho del alfa en anchos del pincel: por debajo de 1 se repite, por encima se recorta
number-set = conjunto
    .about = número del conjunto que se dibuja; 0: cada trazo empieza uno nuevo

## The brush's settings

brush-more = Más pinceles
brush-now = Pincel: { $name }
brush-favourites = Favoritos
brush-favourite = Favorito
    .tip = Figura primero entre los pinceles
brush-own = Propios
    .tip = { $what } (otra vez: como se guardó)
brush-own-about = { $kind }: { $about }
brush-radius = Radio
    .tip = A plena presión ({ $keys }, o { $drag } y arrastrar)
brush-radius-pixels = Radio en píxeles
    .tip = El pincel conserva su tamaño en pantalla al acercar la vista; desactivado: su tamaño en el objeto
brush-strength = Fuerza
    .tip = Cuánto hace un toque ({ $keys }, o { $drag } y arrastrar)
brush-carve = Tallar
    .tip = { $action }; mantén Ctrl para un solo trazo
brush-stroke = Trazo
brush-settings = Más ajustes
brush-dab = Forma del toque
brush-stamp = Alfa y sello
brush-automasks = Máscaras automáticas
brush-topology = Topología dinámica
brush-save = Guardar este pincel
    .tip = Figura entre los propios, con todos sus ajustes y su imagen
brush-save-name = Nombre
brush-save-new = Guardar
brush-save-replace = Reemplazar
brush-save-wrong = Hasta 64 letras, cifras, espacios, - y _, y no el nombre de un pincel del programa

stroke-spacing = Espaciado
    .tip = Distancia entre toques como parte del radio
stroke-stabilizer = Estabilizar
    .tip = El pincel sigue al lápiz a esta distancia: una parte de la altura de la vista
stroke-steadiness = Firmeza
    .tip = Longitud del hilo con que el pincel sigue al lápiz, en radios
stroke-average = Muestras promediadas
    .tip = El pincel va a la media de tantas muestras del lápiz
stroke-jitter = Dispersión
    .tip = Cuánto se dispersan los toques en torno al camino, en radios
stroke-seed = Semilla de dispersión:
stroke-method = Método
stroke-continuous = Seguir con el lápiz quieto
stroke-ticks = Ciclos entre toques en reposo
stroke-compensate = Misma fuerza con todo espaciado
    .tip = La fuerza cuenta por el camino del lápiz; si no, cada toque la tiene entera
stroke-accumulate = Acumular
    .tip = Un trazo crece sobre lo que él mismo ha levantado
stroke-limit = Límite del trazo
    .tip = Cuánto puede mover un trazo un punto, en alturas de un toque entero; 0: sin límite

method-space = Espaciado
method-dots = Puntos
method-airbrush = Aerógrafo
method-anchored = Anclado
method-drag-dot = Punto arrastrado
method-line = Línea
method-curve = Curva por puntos

dab-falloff = Decaimiento
dab-curve-tip = A { $eighths } octavos del radio
dab-hardness = Dureza
    .tip = Parte del radio en que el pincel actúa del todo
dab-smoothing = Suavizado
    .tip = Cada toque se suaviza con esta fuerza
dab-averaging = Promedio
    .tip = Parte del radio en que se promedia el plano de la superficie
dab-plane-trim = Límite del plano
    .tip = Lo que está más lejos del plano queda, en radios; 0: nada
dab-tilt = Inclinación
    .tip = Cuánto se inclina un toque con el lápiz
dab-colour = Color

colour-sample = Tomar
    .tip = { $action }: el próximo clic en la arcilla toma su color
colour-sample-here = Hacer clic en el color de la arcilla
colour-keep = Conservar
    .tip = El color figura abajo desde ahora
colour-swatch = Color { $code }
    .tip = { $code }: un clic lo toma, el botón derecho lo quita
colour-nothing = No hay arcilla bajo el puntero

falloff-gaussian = Gaussiano
falloff-smooth = Suave
falloff-sphere = Esfera
falloff-root = Raíz
falloff-sharp = Agudo
falloff-linear = Lineal
falloff-constant = Constante
falloff-custom = Propio

stamp-alpha = Alfa
stamp-stamp = Sello
stamp-size = Tamaño del sello
stamp-angle = Ángulo del sello
stamp-repeat = Repetir el sello
stamp-right = Plantilla a la derecha
stamp-up = Plantilla arriba
stamp-at-tip = Desde el centro de la vista, en alturas suyas
stamp-off = Ninguno
stamp-dab = Bajo cada toque
stamp-view = Según la vista
stamp-stencil = Plantilla

alpha-studs = Tachuelas
alpha-scales = Escamas
alpha-rope = Cuerda
alpha-stitches = Puntadas
alpha-waves = Olas
alpha-bricks = Ladrillos
alpha-stone = Piedra
alpha-cracks = Grietas
alpha-picture = Imagen cargada

automask-front = Solo caras frontales
automask-topology = Solo partes conectadas
automask-sets = Solo el conjunto del primer toque
automask-boundary = Los bordes quedan
    .tip = El borde de una superficie abierta no se mueve
automask-normal = Límite de normal
    .tip = Solo lo que se aparta de la normal del toque como mucho estos grados; 0: todo
automask-cavity = Cavidad
    .tip = Por encima de 0 solo huecos, por debajo solo aristas

topology-by = Longitud de aristas
topology-length = Longitud
topology-split = Dividir aristas largas
topology-collapse = Unir aristas cortas
topology-off = No
topology-brush = Parte del pincel
topology-object = Parte del objeto
topology-view = Parte de la vista

## Mirror, pressure, masks, history

mirror-heading = Simetría

pressure-heading = Presión
pressure-curve = Curva de presión
    .tip = Arrastra el extremo izquierdo para el toque más leve, el centro para la curvatura
pressure-lightest = Mínimo
pressure-bend = Curvatura
pressure-radius = Radio
    .tip = Parte del radio en el toque más leve
pressure-radius-curve = Curva de presión del radio
pressure-radius-bend = Curvatura del radio

mask-heading = Máscara
mask-clear = Vaciar
    .tip = Todo queda libre
mask-fill = Llenar
    .tip = Todo queda protegido
mask-invert = Invertir
    .tip = Lo libre se protege, lo protegido se libera
mask-blur = Difuminar
    .tip = Un borde más blando
mask-sharpen = Enfocar
    .tip = Un borde más duro
mask-grow = Crecer
    .tip = Un anillo de vértices más
mask-shrink = Encoger
    .tip = Un anillo menos
mask-cavity = Huecos
    .tip = Los huecos quedan protegidos
mask-thin = Zonas finas
    .tip = Lo que tiene como mucho este grosor queda protegido
mask-occlusion = Resguardado
    .tip = Lo que el objeto aparta de la luz queda protegido
mask-thin-below = fino es
    .tip = Parte del lado más largo
mask-note = { $keys } la muestra; el pincel máscara la pinta

history-heading = Historial
history-steps = { $at } de { $all }
history-versions = { $count ->
    [one] { $count } versión
   *[other] { $count } versiones
}
history-step = Paso
    .tip = Arrastra para recorrer los pasos
history-after = Tras el paso { $step }
history-version = Versión
    .tip = Arrastra para recorrer las versiones de esta línea
history-row = Versión { $node }, en { $time }
history-row-branch = Versión { $node }, en { $time }, en una rama
history-replaced = reemplazado
history-added = añadido
history-removed = quitado
history-duplicated = duplicado
history-renamed = renombrado
history-moved = movido
history-activated = activado
history-shown = mostrado u oculto
history-locked = bloqueado o no
history-reshaped = reformado
history-layers = capas
history-sets = conjuntos de caras
history-mask = máscara
history-remesh = tamaño de triángulos
history-snapped = pegado
history-arranged = reordenado
history-set-named = conjunto nombrado
history-followed = siguió a sus operandos
history-applied = booleana aplicada
history-mirrored = reflejado
history-boolean = booleana
history-merged = unido
history-split = separado

## Page: look

look-material = Material
material-clay = arcilla
material-porcelain = porcelana
material-wax = cera
material-stone = piedra
material-jade = jade
material-bronze = bronce
material-graphite = grafito
material-steel = acero
light-name = Luz
    .tip = Las imágenes del entorno (HDR, EXR) y de bolas iluminadas, cuadradas, se guardan al soltarlas en la ventana
light-studio = Estudio
light-room = Sala
light-matcap = Bola iluminada
light-turned = Giro
light-raised = Altura
light-shadow = Sombras
    .tip = { $action }: lo que está ante la luz principal oscurece lo que queda detrás
light-bright = Brillo
reference-name = Referencia
    .tip = Suelte en la ventana una imagen que no sea cuadrada
reference-none = Ninguna
reference-behind = Detrás de la arcilla
reference-opacity = Opacidad
look-facets = Facetas
look-cavity = Cavidad
    .tip = Huecos más oscuros, aristas más claras
look-occlusion = Oclusión
    .tip = { $action }: oclusión ambiental en espacio de pantalla
look-wireframe = Malla de alambre
look-grid = Cuadrícula
look-smooth-edges = Bordes suaves
    .tip = Cuatro muestras por píxel; cuesta tiempo donde no dibuja una tarjeta gráfica
look-map = Mapa
map-none = Ninguno
    .tip = La propia arcilla
map-mask = Máscara
map-thickness = Grosor
map-distance = Distancia
look-camera = Cámara
look-orthographic = Ortográfica
look-angle = Ángulo
    .tip = Campo de visión, grados
look-four-views = Cuatro vistas
view-top = Desde arriba
view-free = Libre
view-front = De frente
view-right = Desde la derecha
view-alone = Muestra solo esta vista, como un doble clic junto a la arcilla. Con «{ $action }» se va y se vuelve.
views-no-copies = Las cuatro vistas necesitan una pantalla a la que se puedan copiar imágenes, y este controlador no lo ofrece. Se sigue trabajando en una vista.
look-keep = Guardar la vista
    .tip = Guarda esta vista con un número, para volver a ella
    .show = Muestra de nuevo esta vista; un clic derecho la olvida
legend-measuring = midiendo

## Page: scene

scene-object = Objeto
scene-size = { $x } x { $y } x { $z } { $unit }
scene-held = Objeto sostenido
    .tip = Aparece junto al objeto, para moverlo dentro de él
scene-held-note = Toma una forma, muévela a su sitio y luego une, corta o conserva.
scene-add = Unir
    .tip = Los dos se hacen uno
scene-cut = Cortar
    .tip = Lo sostenido se corta del objeto
scene-keep = Intersecar
    .tip = Solo queda lo que está en ambos
scene-put-down = Dejar
    .tip = Se vuelve un objeto donde está
scene-put-away = Guardar
scene-busy = calculando en segundo plano: sigue esculpiendo
scene-preview = Vista previa
scene-computing = calculando ...
scene-shown = { $count } triángulos del objeto sostenido
scene-apply = Aplicar
    .tip = Hacer lo que se muestra
scene-dismiss = Descartar
    .tip = El objeto queda como está; el sostenido también
scene-yaw = guiñada
scene-pitch = cabeceo
scene-roll = alabeo
scene-scale = escala
scene-held-size = tamaño

objects-heading = Objetos
objects-add = Añadir objeto
objects-duplicate = Duplicar
objects-rename = Renombrar
objects-remove = Quitar
objects-locked = Bloqueado: ni trazos, ni movimientos, ni borrado
objects-group = Grupo
    .tip = Da nombre al grupo del objeto; un nombre vacío lo quita
objects-mirror = Reflejar
objects-live = Booleanas vivas
    .tip = Los operandos quedan ocultos y el resultado se calcula de nuevo cuando uno cambia
objects-follows = Sigue a sus operandos
objects-apply = Aplicar
    .tip = Los operandos se van y el resultado queda como está
objects-gizmo = Gizmo
    .tip = Mueve, gira y escala el objeto con el puntero; con Ctrl, por pasos
objects-snap = Pegar cara con cara
    .tip = Pone una cara plana de un objeto a ras con la de otro
objects-snap-first = Pulse la cara que se mueve
objects-snap-second = Pulse la cara a la que se pega
objects-eye = ver
    .tip = Se dibuja
objects-lock = fijo
    .tip = Protegido de trazos, movimientos y borrado
objects-reset-place = Reponer lugar
    .tip = De vuelta a donde se creó
shape-box = Cubo
shape-ball = Esfera
shape-cylinder = Cilindro
shape-cone = Cono
shape-torus = Toro
shape-tube = Tubo
shape-plane = Plano
operation-all = Los cuatro
    .tip = Unión, intersección y ambas diferencias, cada una un objeto
operation-union = Unión
    .tip = El objeto activo y este se hacen uno
operation-intersection = Intersección
    .tip = Solo queda lo que está en ambos
operation-difference = Diferencia
    .tip = Este objeto se corta del activo
operation-reverse-difference = Diferencia inversa
    .tip = El activo se corta de este

sets-heading = Conjuntos de caras
sets-eye-tip = Mostrar u ocultar el conjunto
sets-colours = Mostrar con colores
sets-isolate = solo
    .tip = Oculta todo menos este conjunto
sets-draw = dibujar
    .tip = Toma el pincel que dibuja este conjunto
sets-none = sin conjunto: { $count }
sets-row = conjunto { $number }: { $count }
sets-hide-masked = Ocultar lo enmascarado
    .tip = Oculta lo enmascarado al menos a medias
sets-invert = Invertir lo visible
    .tip = Oculta lo visible y muestra lo oculto
sets-show-all = Mostrar todo
    .tip = Ya nada está oculto
sets-clear = Vaciar conjuntos
    .tip = Ningún vértice está ya en un conjunto; lo oculto sigue oculto
sets-from-mask = De la máscara
    .tip = Lo enmascarado al menos a medias pasa a ser un conjunto
sets-from-visible = De lo visible
    .tip = Todo lo visible pasa a ser un conjunto
sets-loose = Partes sueltas
    .tip = Cada parte conexa pasa a ser un conjunto
sets-normals = Por dirección
    .tip = Cada parte que mira a un mismo lado pasa a ser un conjunto
sets-crease = Por pliegues
    .tip = Los conjuntos se tocan donde la superficie se dobla más que el ángulo
sets-degrees = Ángulo
sets-thickness = Grosor
    .tip = Parte del lado más largo; bajo 0 hacia dentro
sets-extract-mask = Extraer la máscara
    .tip = Lo enmascarado pasa a ser un objeto: una cáscara cerrada de este grosor
sets-extract-name = extracto

layers-heading = Capas
layers-add = Añadir capa
    .tip = Los trazos van a la nueva capa
layers-name = capa { $number }
layers-base = base
    .tip = Los trazos quedan bajo todas las capas
layers-unseen = La capa activa está oculta o su intensidad es 0: los trazos no se verían
layers-topology = La topología dinámica descansa mientras el objeto tiene capas; consolídalas para usarla
layers-eye = ver
    .tip = Visible
layers-up = Subir
    .tip = Sobre la capa siguiente
layers-down = Bajar
    .tip = Bajo la capa siguiente
layers-merge = Unir hacia abajo
    .tip = La añade a la capa de abajo, o a la base. Ambas deben verse
layers-duplicate = Duplicar capa
    .tip = Una gemela oculta sobre ella
layers-clear = Vaciar capa
    .tip = Quita lo que hace
layers-remove = Quitar capa
    .tip = La quita con lo que hace
layers-rename = Renombrar capa
layers-bake = Consolidar capas
    .tip = La superficie como está pasa a ser la base

levels-heading = Niveles
levels-at = nivel { $at } de { $all }, { $count } triángulos
levels-coarser = Más basto
    .tip = Dar forma al conjunto; el detalle de niveles finos lo acompaña
levels-finer = Más fino
    .tip = Cuatro triángulos por cada uno
    .back = Volver al nivel más fino

remesh-heading = Remallar
remesh-own = Vóxel propio
    .tip = Si no, los triángulos nuevos son más o menos como los actuales
remesh-voxel = vóxel
remesh-along = { $count } en el lado más largo
remesh-sharp = Conservar aristas vivas
remesh-button = Remallar
    .tip = Una superficie de triángulos uniformes; las partes superpuestas se hacen una. { $keys }
remesh-local-heading = En el lugar
remesh-local-edge = Longitud de arista
    .tip = Veces la longitud de arista habitual del objeto
remesh-local-undo = { $keys } lo deshace en todo momento, también mientras está en curso.
remesh-stretched = Refinar lo estirado
    .tip = Divide las aristas demasiado largas de todo el objeto; lo enmascarado u oculto se queda

quads-heading = Cuadriláteros
quads-count = cuadriláteros
quads-levels = niveles más finos
    .tip = Los cuadriláteros son el nivel más bajo; los niveles más finos devuelven el detalle
quads-button = Remallar en cuadriláteros
    .tip = Cuadriláteros que siguen la forma; una exportación sin niveles los escribe

decimate-heading = Diezmado
decimate-share = de los triángulos
decimate-button = Diezmar
    .tip = Menos triángulos, para imprimir y para la web. Sin nuevas autointersecciones, y el borde de la máscara se queda

trim-heading = Recorte
trim-box = Caja
    .tip = Arrastra una caja sobre la vista: lo que hay en ella se corta de lado a lado
trim-line = Línea
    .tip = Arrastra una línea sobre la vista: lo que queda a su izquierda se corta
trim-note = Arrastra sobre la vista; Esc cancela.

region-heading = Región de la vista
region-draw = Región:
region-lasso = Lazo
    .tip = Arrastra alrededor de lo que quieras
region-box = Caja
    .tip = Arrastra de esquina a esquina
region-line = Línea
    .tip = Arrastra una línea: cuenta lo que queda a su izquierda
region-polyline = Polilínea
    .tip = Pulsa esquina por esquina
region-front = Solo caras frontales
    .tip = Solo lo que mira hacia ti; si no, de lado a lado
region-mask = Enmascarar
    .tip = Protege lo que hay en la región; con Ctrl: lo libera
region-unmask = Desenmascarar
    .tip = Libera lo que hay en la región; con Ctrl: lo protege
region-hide = Ocultar
    .tip = Oculta lo que hay en la región; con Ctrl: todo lo demás
region-isolate = Mostrar solo
    .tip = Oculta todo lo demás; con Ctrl: lo que hay en la región
region-face-set = Conjunto
    .tip = Lo que hay en la región pasa a ser un conjunto nuevo
region-remesh = Tamaño de triángulos
    .tip = Los triángulos de la región reciben esta longitud de arista, a través de todo el objeto
region-done = Listo
    .tip = Termina de dibujar regiones (Esc)
region-note = Arrastra sobre la vista. Ctrl invierte, Esc termina.
region-polyline-note = Pulsa cada esquina; otra vez la primera o la última, o Intro, la cierra.

menu-add = unir
menu-carve = tallar
menu-keep = lo común
menu-put-away = guardar
menu-ball = esfera
menu-box = cubo
menu-cylinder = cilindro
menu-undo = deshacer
menu-redo = rehacer
menu-pick-up = coger

## Page: walls

walls-heading = Grosor de las paredes
walls-live = Mapa en vivo
walls-process = Proceso
walls-own-limit = límite propio
walls-too-thin-below = Muy fino bajo
walls-note = Pulsa { $keys }: el mapa sigue a la arcilla mientras esculpes.
walls-thinnest = mínimo
walls-median = mediana
walls-thickest = máximo
walls-too-thin = muy fino
walls-measured = medido
walls-spots = Puntos finos
walls-none = Ninguno bajo el límite.
walls-spot = { $number }: { $value } mm
    .tip = La cámara vuela allí
walls-histogram = Histograma de grosor
    .tip = { $min } a { $max } mm; la línea es el límite
process-abs = Moldeo por inyección, ABS
process-fdm = Filamento fundido (FDM)
process-pa = Moldeo por inyección, poliamida (PA)
process-pc = Moldeo por inyección, policarbonato (PC)
process-pom = Moldeo por inyección, acetal (POM)
process-pp = Moldeo por inyección, polipropileno (PP)
process-sla = Estereolitografía (SLA)
process-sls = Sinterizado láser (SLS)

## Page: size

measure-heading = Medidas
measure-waits = Se mide cuando nada cambia.
measure-volume = volumen
measure-area = área
measure-size = tamaño { $axis }
measure-shadow = sombra { $axis }
measure-stale = De un estado anterior; se mide de nuevo cuando nada cambia.
shadow-heading = Sombra
shadow-along = sombra según { $axis }
    .tip = Mirando según { $axis }
shadow-here = Desde aquí
    .tip = Mirando como la cámara
shadow-size = { $x } x { $y } mm, { $holes } agujeros
shadow-file = Dibujo que se escribe
    .tip = El archivo del dibujo
shadow-write = SVG
    .tip = El contorno como dibujo a escala, milímetros
shadow-outline = Contorno de la sombra
distance-heading = Distancia
distance-live = Mapa de distancias
distance-before = a lo anterior
    .tip = Al objeto como se abrió
distance-held = al objeto sostenido
distance-now = Comparar con ahora
    .tip = Las distancias se miden al objeto como está ahora
distance-note = Azul está dentro, rojo fuera.
distance-deepest = más hondo
distance-highest = más alto
distance-rms = rms
distance-known = conocido

## Page: files

files-open = Abrir
    .note = Suelta una malla en la ventana, o:
files-open-name = Archivo que abrir
files-browse = Examinar...
files-recent = Recientes
files-earlier = Esculturas anteriores
files-export = Exportar
files-export-name = Archivo que escribir
files-scale = Escala
files-unit = Unidad
unit-pixel = px
unit-mm = mm
unit-cm = cm
unit-m = m
unit-inch = pulg.
files-save-as = Guardar como...
files-pictures = Imágenes
files-screenshot = Captura
files-turntable = Giro completo
files-frames = cuadros
files-replace = Reemplazar
    .question = { $path } ya existe. ¿Reemplazarlo?

chooser-open = Abrir una malla
chooser-export = Exportar la escultura
chooser-meshes = Mallas
chooser-home = Personal
chooser-documents = Documentos
chooser-downloads = Descargas
chooser-desktop = Escritorio
chooser-up = Subir
chooser-reading = leyendo...
chooser-empty = aquí no hay carpetas ni archivos de malla
chooser-name = Nombre

start-heading = Seguir con
start-note = Esta nueva escultura se guarda mientras trabajas.
start-stay = Quedarse aquí
start-session = { $object }, { $date } { $time }

## Page: pens

devices-heading = Dispositivos
devices-none = No hay tableta: conecta una, sin reiniciar nada.
    .mouse = El ratón también esculpe: los trazos lentos aprietan más.
devices-camera = Cámara
    .privacy = Las imágenes no salen de este programa ni se guardan.
devices-in-range = Ahora al alcance
devices-pointer = puntero
devices-tablet = tableta { $number }
devices-serial = lápiz serie { $number }
devices-recording = grabación { $number }
devices-demo = lápiz de demo { $number }
devices-pen = lápiz { $number }
devices-eraser = { $pen }, goma
devices-no-tilt = sin inclinación
devices-tilt = inclinación { $x }, { $y } grados
devices-pressure = presión { $pressure }, { $tilt }
devices-place = en { $x } %, { $y } % de la vista
devices-hands = { $count ->
    [one] una mano detectada
   *[other] { $count } manos detectadas
}
devices-strain = esfuerzo del brazo { $percent } %
devices-rest = El brazo trabaja alto: descánsalo o trabaja más abajo.
devices-nothing = nada
devices-curve = La curva de presión a la izquierda muestra la traza en vivo del lápiz.
pose-neutral = Neutra
pose-point = Índice
pose-pinch = Pellizco
pose-grab = Puño
pose-flat = Plana
pose-open = Abierta

tablet-heading = Teclas de la tableta
tablet-choose = Elegir pulsándola
    .tip = Luego pulsa la tecla de la tableta o el botón del lápiz, o gira el anillo. Mientras tanto no hace otra cosa
tablet-listening = Pulsa ahora una tecla...
tablet-usual = Como siempre ({ $action })
tablet-action = Acción de { $control }
tablet-line = { $control }: { $action }
tablet-reset = Restablecer
    .tip = De nuevo como siempre
tablet-none = Todo hace lo que suele hacer.
tablet-nothing = Nada
tablet-next-mode = Modo siguiente
tablet-radius = Radio
    .back = Radio, al revés
tablet-strength = Fuerza
    .back = Fuerza, al revés
tablet-turn = Girar la vista al mantener
tablet-slide = Mover la vista al mantener
tablet-zoom = Zoom al mantener
tablet-radius-and-strength = Radio y fuerza arrastrando
tablet-carve = Tallar al mantener
tablet-brush = Pincel { $brush }
    .held = Pincel { $brush } al mantener
control-key = Tecla { $number }
control-barrel = Botón { $number }
control-eraser = Goma
control-wheel = Rueda { $number }
control-ring = Anillo { $number }
control-strip = Tira { $number }

## Page: loop

loop-heading = Ciclo
loop-tick = ciclo
loop-late = tardíos
loop-samples = muestras
loop-dabs = toques
loop-lost = perdidos
    .note = perdidos: movimiento + contactos
loop-window = Esta ventana
loop-frames = cuadros/s
loop-frame = cuadro
loop-worst = peor
loop-to-clay = a arcilla
loop-to-screen = a pantalla
    .note = a arcilla, a pantalla: desde la última muestra
loop-in-view = a la vista
loop-of = { $part } de { $all }
loop-uploaded = enviado
loop-object = Objeto
loop-vertices = vértices
loop-triangles = triángulos
loop-saved = se guarda mientras trabajas: { $path }
loop-sample-to-screen = De la muestra a la pantalla
loop-up-to = hasta { $value } ms
loop-longer = más
loop-class = { $class }: { $count }
loop-histogram = { $frames } cuadros; { $first } ms, y el doble con cada barra
stage-tick = ciclo
    .about = de la lectura al final del ciclo que la tomó
stage-wait = espera
    .about = del final de ese ciclo al comienzo de un cuadro
stage-draw = dibujo
    .about = del comienzo del cuadro a la entrega de su imagen
stage-present = muestra
    .about = de la entrega a la presentación
stage-total = total
    .about = de la lectura a la presentación

## Page: more

preferences-heading = Preferencias
preferences-language = Idioma
preferences-language-system = Del sistema ({ $name })
preferences-font = { $name } necesita una fuente que falta en este equipo. Instala una con sus letras, como Noto Sans CJK, y elige el idioma de nuevo.
preferences-text-size = Texto
preferences-light = Paneles claros
preferences-speed = La velocidad es presión
    .tip = Para un ratón: los trazos lentos aprietan más que los rápidos
preferences-lead = Mostrar el trazo por delante del lápiz
    .tip = Lo que el lápiz levantará hasta que se vea la imagen; la arcilla depende solo del lápiz
preferences-fingers = Dos dedos
    .tip = En una pantalla táctil. Pellizcando hacen zoom; tres dedos hacen lo otro, tocar con tres deshace, con cuatro rehace
preferences-fingers-turn = Girar
preferences-fingers-slide = Mover
preferences-lesson-skip = Saltar la lección
preferences-lesson-again = Repetir la primera lección
preferences-keys = Teclas...
preferences-help = Ayuda
preferences-search = Buscar acciones
preferences-no-session = Sin archivo de sesión: la escultura solo se conserva si la exportas.

messages-heading = Mensajes
messages-loading = Cargando { $name }

## The window of the keys

keys-heading = Teclas
keys-set = Conjunto
keys-as-in-set = Como en el conjunto
    .tip = Olvida toda tecla que hayas cambiado
keys-find = Buscar
keys-note = Haz clic en las teclas de una acción para cambiarlas.
keys-shared = { $count ->
    [one] { $count } acción comparte teclas con otra
   *[other] { $count } acciones comparten teclas con otra
}
keys-press = Pulsa teclas...
keys-of = Teclas de { $action }
    .tip = Haz clic y pulsa las teclas nuevas. Esc las deja, Supr las quita
keys-also = también: { $actions } (prevalece la elegida)
    .own = también: { $actions } (se hace esta)
keys-unknown-action = keys.own: ninguna acción se llama "{ $id }"
keys-unreadable = keys.own.{ $id }: "{ $keys }" no es una tecla: se espera por ejemplo Z, F12, [ o Ctrl+Shift+Z

## Search, radial menu, dragged settings, curves

search-heading = Buscar acciones
search-nothing = nada se llama así

radial-radius = Radio
radial-mirror = Simetría x
radial-thickness = Grosor
radial-frame = Encuadrar
radial-strength = Fuerza
radial-carve = Tallar

modal-radius = Radio { $value }: clic para conservarlo, Esc para dejarlo como estaba
modal-strength = Fuerza { $value }: clic para conservarla, Esc para dejarla como estaba

curve-note = Dibuja o pon puntos: se pueden cambiar antes de que el pincel los siga.
curve-points = { $count ->
    [one] { $count } punto
   *[other] { $count } puntos
}
curve-draw = Trazar la curva
    .tip = El pincel la sigue, en un solo paso (Intro)
curve-remove = Quitar el punto
    .tip = Supr, o el botón derecho sobre él
curve-discard = Descartar
    .tip = No se traza nada (Esc)

## The first lesson

lesson-demo = La demostración está en marcha. Toca la arcilla cuando quieras
lesson-line = { $hint } ({ $at } de { $all })
lesson-sculpt = Pulsa y arrastra sobre la arcilla
lesson-turn = Arrastra junto a la arcilla para girarla, usa la rueda para el zoom
lesson-smooth = Mantén Mayús y pasa sobre lo que hiciste: se suaviza
lesson-carve = Mantén Ctrl y traza: talla en vez de levantar
lesson-undo = { $keys } deshace el último trazo
lesson-mirror = { $keys }, o x en Simetría a la izquierda, y un trazo: ambos lados
    .no-keys = Elige x en Simetría a la izquierda y haz un trazo: ambos lados

## Help

help-heading = Ayuda
help-pages = Páginas a la derecha
help-keys = Teclas
help-pen = Lápiz o ratón
help-pen-press = Pulsar y arrastrar sobre la arcilla
    .does = Esculpir
help-pen-carve = Lo mismo con Ctrl o Alt
    .does = Tallar en vez de levantar, en un trazo
help-pen-smooth = Lo mismo con Mayús
    .does = Suavizar, en un trazo
help-pen-turn = Arrastrar junto a la arcilla, o con el botón derecho
    .does = Girar la vista
help-pen-slide = Botón central, o derecho con Mayús
    .does = Mover la vista
help-pen-zoom = Rueda
    .does = Acercarse a lo que está bajo el puntero
help-pen-menu = Mantener Espacio
    .does = Menú en torno al puntero
help-fingers = Dedos en una pantalla
help-fingers-one = Un dedo sobre la arcilla
    .does = Esculpir
help-fingers-two = Dos dedos
    .does = Girar la vista; pellizcando hacen zoom
help-fingers-three = Tres dedos
    .does = Mover la vista (la página Más los intercambia)
help-fingers-tap = Tocar con tres, con cuatro
    .does = Deshacer, rehacer
help-hands = Manos desnudas sobre un sensor
help-hands-index = Índice extendido
    .does = La yema empuja la arcilla
help-hands-pinch = Pulgar e índice cerrados
    .does = Sujetar arcilla, llevarla, soltarla
help-hands-flat = Dedos extendidos y juntos
    .does = La palma aprieta y suaviza
help-hands-open = Dedos extendidos y separados
    .does = Girar la vista; con dos manos, zoom
help-hands-fist = Puño
    .does = Mover la vista
help-hands-both = Pellizcar con ambas manos
    .does = Sujetar la escultura: girarla, moverla, escalarla
help-hands-menu = Un dedo reposa en una esfera a la izquierda
    .does = Elegir del menú de las manos
help-work = El trabajo se conserva
help-work-close = Cerrar la ventana cuando se quiera
    .does = La sesión sigue donde estaba
help-work-files = Página Archivos
    .does = Abrir, exportar, esculturas anteriores

## Actions

action-brush = Pincel { $brush }
action-page = Página: { $page }
action-undo = Deshacer
action-redo = Rehacer
action-carve = Tallar o levantar
action-larger = Pincel más grande
action-smaller = Pincel más pequeño
action-stronger = Pincel más fuerte
action-weaker = Pincel más débil
action-drag-radius = Arrastrar el radio
action-drag-strength = Arrastrar la fuerza
action-sample-colour = Tomar el color
action-mirror-x = Simetría en x
action-mirror-y = Simetría en y
action-mirror-z = Simetría en z
action-frame = Encuadrar la escultura
action-front = Vista frontal
action-back = Vista trasera
action-left = Vista izquierda
action-right = Vista derecha
action-top = Vista superior
action-bottom = Vista inferior
action-perspective = Perspectiva u ortográfica
action-four-views = Cuatro vistas o una
action-next-material = Material siguiente
action-facets = Sombreado suave o plano
action-ssao = Oclusión ambiental
action-shadows = Sombras
action-wireframe = Malla de alambre
action-grid = Cuadrícula
action-thickness = Mapa de grosor
action-mask = Mapa de máscara
action-distance = Mapa de distancias
action-trim-box = Recortar con una caja
action-trim-line = Recortar con una línea
action-region-lasso = Región con lazo
action-region-box = Región con una caja
action-region-line = Región con una línea
action-region-polyline = Región con polilínea
action-region-mask = Enmascarar una región
action-region-unmask = Desenmascarar una región
action-region-hide = Ocultar una región
action-region-isolate = Mostrar solo una región
action-region-face-set = Conjunto de una región
action-finer = Nivel más fino
action-coarser = Nivel más basto
action-remesh = Remallar
action-try-add = Vista previa: unir el objeto sostenido
action-try-cut = Vista previa: cortar con el objeto sostenido
action-try-keep = Vista previa: conservar lo común
action-open-mesh = Abrir una malla
action-export = Exportar la malla
action-screenshot = Captura de pantalla
action-turntable = Cuadros del giro completo
action-search = Buscar acciones
action-panels = Paneles
action-light-or-dark = Claro u oscuro
action-larger-text = Texto más grande
action-smaller-text = Texto más pequeño
action-help = Ayuda
action-keys = Cambiar las teclas
action-lesson = Primera lección

## Messages of background tasks

task-loaded = { $name }: { $count } vértices
task-exported = Guardado { $path }: { $x } x { $y } x { $z } { $unit }
task-saved = Guardado { $path }
task-frames = Guardados { $frames } cuadros en { $folder }
task-failed = { $path }: { $error }
task-done = { $operation }: hecho
task-snapped = Las caras están a ras
task-mirrored = Se añadió un gemelo reflejado
task-trimmed = Recortado
task-level = Nivel { $at } de { $all }
task-remesh-local = Aristas cambiadas: { $count }
task-remesh-taken-back = La nueva malla se deshizo antes de terminar.
task-remeshed = Remallado: { $count } triángulos, vóxeles de { $voxel }, volumen { $change } %; intersecciones: { $crossings }
task-remesh-lost = Se perdieron partes más finas que un vóxel, por ejemplo en { $x }, { $y }, { $z }: deshaz y usa un vóxel más pequeño
task-quads = { $quads } cuadriláteros y { $triangles } triángulos; intersecciones: { $crossings }
task-decimated = { $before } triángulos pasaron a { $now }; nuevas intersecciones: { $crossings }
task-layers-baked = Capas consolidadas en la nueva superficie: { $count }
task-sets-made = Conjuntos de caras creados
task-mask-measured = Enmascarados: { $count } vértices
task-sets-dropped = Los conjuntos de caras se fueron con la superficie anterior; ya nada está oculto
task-extracted = Objeto de { $count } vértices extraído
task-preferences-unreadable = { $path }: { $error }; se conserva como { $aside }
task-preferences-stuck = { $path }: { $error }; no se puede apartar: { $why }
task-brush-saved = El pincel { $name } está guardado
task-brush-not-saved = El pincel no está guardado: { $error }
task-picture-kept = Guardada como { $path }
task-preferences-unread = { $path }: no se pueden leer las preferencias: { $error }
task-preferences-not-kept = { $path }: las preferencias no se guardan: { $error }
language-unreadable = { $path }: { $error }

## People who share the sculpture

people-heading = Personas
people-you = { $name } (tú)
people-gone = Se fueron: { $names }
people-sculptor = escultor
people-viewer = espectador
people-device = dispositivo
people-invite = Invitar con un código
people-invite-about = Escanéalo con un teléfono o una tableta de esta red, o abre el enlace: se esculpe en el navegador.
people-invite-copy = Copiar el enlace
undo-in-the-way = No se deshizo: { $name } ha cambiado después el mismo lugar. Cuando { $name } lo deshaga, se podrá.
redo-in-the-way = No se rehízo: { $name } ha cambiado después el mismo lugar. Cuando { $name } lo deshaga, se podrá.
