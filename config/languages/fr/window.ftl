# What the window says in French; config/languages/en/window.ftl holds the English of every message.

language-name = Français
    .latin = Français

## Keys that are held with another one

key-ctrl = Ctrl
key-alt = Alt
key-shift = Maj

## Words that many places share

off = non
none = aucun
cancel = Annuler
reset = Réinitialiser
undo = Annuler
redo = Refaire
open = Ouvrir
export = Exporter
length-mm = { $value } mm
area-mm2 = { $value } mm²
volume-mm3 = { $value } mm³
time-ms = { $value } ms
percent = { $value } %
size-bytes = { $value } o
size-kilobytes = { $value } ko
size-megabytes = { $value } Mo
triangles = { $count } triangles
both-keys = { $first } et { $second }
name-with-keys = { $name } ({ $keys })

## Pages at the right

page-look = Vue
    .about = Comment l'argile est montrée
page-scene = Scène
    .about = Un second objet, opérations booléennes, niveaux de détail, rognage
page-walls = Parois
    .about = Épaisseur des parois et points minces
page-measure = Mesures
    .about = Mesures, ombre dans une direction, distances à une autre forme
page-files = Fichiers
    .about = Ouvrir, exporter, images
page-devices = Stylets
    .about = Appareils et leurs valeurs en direct
page-loop = Boucle
    .about = Temps de la boucle de calcul et de cette fenêtre
page-more = Plus
    .about = Langue, préférences et messages

## Brushes

kind-gaussian = Gaussienne
    .about = Élève une cloche d'argile selon la normale de la surface (Cipollini 2020).
kind-smooth = Adoucir
    .about = Égalise la surface : laplacien à poids cotangents ; la force est la part du chemin en une touche.
kind-draw = Dessiner
    .about = Élève la surface selon sa normale moyenne, suivant l'atténuation.
kind-clay = Argile
    .about = Ajoute de l'argile en couche plate : remplit jusqu'à un plan un peu au-dessus de la surface.
kind-clay-strips = Bandes d'argile
    .about = Pose de l'argile en bandes plates aux bouts carrés, tournées selon le trait.
kind-inflate = Gonfler
    .about = Gonfle la forme : chaque sommet selon sa propre normale.
kind-layer = Couche
    .about = Une couche de hauteur égale par trait, si souvent qu'il repasse.
kind-crease = Pli
    .about = Creuse un sillon dont les bords se rapprochent ; en négatif, élève une arête.
kind-pinch = Pincer
    .about = Rassemble la surface vers le milieu de la brosse ; en négatif, l'écarte.
kind-blob = Goutte
    .about = Élève une goutte ronde : la surface gonfle depuis un point sous elle.
kind-flatten = Aplatir
    .about = Ramène bosses et creux au plan moyen ; en négatif, les accentue.
kind-fill = Remplir
    .about = Remplit les creux jusqu'au plan moyen et laisse les bosses ; en négatif, abaisse les bosses.
kind-scrape = Racler
    .about = Abaisse les bosses jusqu'au plan moyen et laisse les creux ; en négatif, remplit les creux.
kind-trim = Rogner
    .about = Coupe ce qui dépasse d'un plan un peu sous la surface, comme un couteau.
kind-grab = Saisir
    .about = Ce qui était sous la brosse quand le stylet s'est posé suit le stylet.
kind-elastic = Élastique
    .about = Déplace l'argile comme un corps élastique tenu en un point (Kelvinlets régularisés, de Goes et James 2017).
kind-topological = Topologique
    .about = Comme Saisir, mais tient ce qui est proche le long de la surface, non à travers l'air.
kind-snake-hook = Crochet
    .about = Étire l'argile derrière le stylet et l'accompagne.
kind-twist = Tordre
    .about = Tourne ce qui était sous la brosse autour de la normale quand le stylet va à droite.
kind-thumb = Pouce
    .about = Étale le long de la surface ce qui était sous la brosse.
kind-nudge = Pousser
    .about = Pousse la surface avec le trait.
kind-relax = Relâcher
    .about = Égalise les triangles le long de la surface et laisse la forme.
kind-mask = Masque
    .about = Protège des autres brosses ce qu'il peint ; en négatif, le libère.
kind-mask-blur = Flou du masque
    .about = Adoucit les bords du masque ; en négatif, les durcit.
kind-paint = Peindre
    .about = Pose la couleur de la brosse sur l'argile.
kind-texture = Texture
    .about = Imprime un alpha en relief le long du trait, courbé comme lui et répété.
kind-density = Densité
    .about = Amène les triangles à la taille voulue, une part de la brosse, et les égalise ; la forme reste.
kind-simplify = Simplifier
    .about = Réunit les petits triangles jusqu'à la taille voulue, une part de la brosse ; les grands et la forme restent.
kind-slide-relax = Glisser
    .about = Fait glisser les triangles le long de la surface avec le trait et laisse la forme ; avec Maj, ou inversé, les relâche.
kind-plane = Plan
    .about = Ramène bosses et creux au plan moyen de la surface telle que le trait l'a trouvée ; en négatif, les accentue.
kind-multiplane-scrape = Double raclage
    .about = Racle deux plans qui se rencontrent le long du trait et laisse une arête aux côtés plats.
kind-sharpen = Aiguiser
    .about = Fait ressortir le relief fin ; en négatif, l'atténue.
kind-surface-smooth = Adoucir surface
    .about = Égalise la surface et garde son volume (Taubin 1995).
kind-boundary = Bord
    .about = Le bord d'une surface ouverte suit le stylet, et la surface derrière lui.
kind-erase-layer = Effacer calque
    .about = Enlève ce que fait le calque actif ; la surface revient à ce qui est dessous.
kind-draw-face-sets = Dessiner groupes
    .about = Dessine des groupes de faces : un nouveau par trait ; en négatif, prolonge le groupe où il a commencé.

## Numbers of single brushes

number-depth = profondeur
    .blob = à quelle profondeur sous la surface est ce point, en rayons
    .plane = jusqu'où la tranche descend sous le plan, en rayons
    .trim = à quelle profondeur sous la surface elle coupe, en rayons, à pleine force
number-lift = élévation
    .about = de combien le plan dépasse la surface, en rayons, à pleine force
number-fill = remplissage
    .about = la part du chemin vers le plan par cinquième de rayon parcouru
number-roundness = rondeur
    .about = 0 un carré, 1 un disque
number-pinch = pincement
    .about = de combien les côtés se rapprochent
number-poisson = Poisson
    .about = combien l'argile garde son volume : 0.5 entièrement
number-offset = décalage
    .about = de combien le plan est déplacé selon sa normale, en rayons
number-angle = angle
    .about = entre les normales des plans, en degrés
number-height = hauteur
    .about = jusqu'où la tranche monte au-dessus du plan, en rayons
number-scale = échelle
    .about = longueur d'une répétition, en largeurs de la brosse
number-floor = niveau zéro
    .about = la hauteur de l'alpha qui reste sur la surface ; ce qui est plus bas est enfoncé
number-width = largeur
    .about = largeur de l'alpha en largeurs de brosse : sous 1 il se répète, au-dessus il est rogné
number-set = groupe
    .about = numéro du groupe dessiné ; 0 : chaque trait en commence un nouveau

## The brush's settings

brush-more = Autres brosses
brush-now = Brosse : { $name }
brush-favourites = Favoris
brush-favourite = Favori
    .tip = Figure en premier parmi les brosses
brush-own = Les vôtres
    .tip = { $what } (encore une fois : comme enregistrée)
brush-own-about = { $kind } : { $about }
brush-radius = Rayon
    .tip = À pleine pression ({ $keys }, ou { $drag } et glisser)
brush-radius-pixels = Rayon en pixels
    .tip = La brosse garde sa taille à l'écran pendant le zoom ; désactivé : sa taille sur l'objet
brush-strength = Force
    .tip = Ce que fait une touche ({ $keys }, ou { $drag } et glisser)
brush-carve = Creuser
    .tip = { $action } ; tenir Ctrl pour un seul trait
brush-stroke = Trait
brush-settings = Autres réglages
brush-dab = Forme d'une touche
brush-stamp = Alpha et tampon
brush-automasks = Masques automatiques
brush-topology = Topologie dynamique
brush-save = Enregistrer cette brosse
    .tip = Elle figure parmi les vôtres, avec tous ses réglages et son image
brush-save-name = Nom
brush-save-new = Enregistrer
brush-save-replace = Remplacer
brush-save-wrong = 64 lettres, chiffres, espaces, - et _ au plus, et pas le nom d'une brosse du programme

stroke-spacing = Espacement
    .tip = Distance entre les touches, en part du rayon
stroke-stabilizer = Stabiliser
    .tip = La brosse suit le stylet à cette distance : une part de la hauteur de la vue
stroke-steadiness = Fermeté
    .tip = Longueur du fil par lequel la brosse suit le stylet, en rayons
stroke-average = Relevés moyennés
    .tip = La brosse va à la moyenne d'autant de relevés du stylet
stroke-jitter = Dispersion
    .tip = De combien les touches sont dispersées autour du chemin, en rayons
stroke-seed = Graine de dispersion :
stroke-method = Méthode
stroke-continuous = Continuer quand le stylet repose
stroke-ticks = Cycles entre touches au repos
stroke-compensate = Même force à tout espacement
    .tip = La force compte sur le chemin du stylet ; sinon chaque touche l'a entière
stroke-accumulate = Accumuler
    .tip = Un trait s'élève sur ce qu'il a lui-même élevé
stroke-limit = Limite d'un trait
    .tip = De combien un trait peut déplacer un point, en hauteurs d'une touche pleine ; 0 : sans limite

method-space = Espacé
method-dots = Points
method-airbrush = Aérographe
method-anchored = Ancré
method-drag-dot = Point glissé
method-line = Ligne
method-curve = Courbe par points

dab-falloff = Atténuation
dab-curve-tip = À { $eighths } huitièmes du rayon
dab-hardness = Dureté
    .tip = Part du rayon où la brosse agit entièrement
dab-smoothing = Lissage
    .tip = Chaque touche est lissée à cette force
dab-averaging = Moyenne
    .tip = Part du rayon où le plan de la surface est moyenné
dab-plane-trim = Limite du plan
    .tip = Ce qui est plus loin du plan reste, en rayons ; 0 : rien
dab-tilt = Inclinaison
    .tip = De combien une touche penche avec le stylet
dab-colour = Couleur

colour-sample = Prélever
    .tip = { $action } : le prochain clic sur l'argile prend sa couleur
colour-sample-here = Cliquer la couleur sur l'argile
colour-keep = Garder
    .tip = La couleur figure désormais ci-dessous
colour-swatch = Couleur { $code }
    .tip = { $code } : un clic la prend, le bouton droit l'enlève
colour-nothing = Il n'y a pas d'argile sous le pointeur

falloff-gaussian = Gaussienne
falloff-smooth = Douce
falloff-sphere = Sphère
falloff-root = Racine
falloff-sharp = Aiguë
falloff-linear = Linéaire
falloff-constant = Constante
falloff-custom = Propre

stamp-alpha = Alpha
stamp-stamp = Tampon
stamp-size = Taille du tampon
stamp-angle = Angle du tampon
stamp-repeat = Répéter le tampon
stamp-right = Pochoir à droite
stamp-up = Pochoir en haut
stamp-at-tip = Depuis le milieu de la vue, en hauteurs de vue
stamp-off = Aucun
stamp-dab = Sous chaque touche
stamp-view = Selon la vue
stamp-stencil = Pochoir

alpha-studs = Clous
alpha-scales = Écailles
alpha-rope = Corde
alpha-stitches = Coutures
alpha-waves = Vagues
alpha-bricks = Briques
alpha-stone = Pierre
alpha-cracks = Fissures
alpha-picture = Image chargée

automask-front = Faces avant seulement
automask-topology = Parties reliées seulement
automask-sets = Seulement le groupe de la première touche
automask-boundary = Les bords restent
    .tip = Le bord d'une surface ouverte ne bouge pas
automask-normal = Limite de normale
    .tip = Seulement ce qui s'écarte de la normale de la touche d'au plus autant de degrés ; 0 : tout
automask-cavity = Cavité
    .tip = Au-dessus de 0 les creux seuls, au-dessous les arêtes seules

topology-by = Longueur d'arêtes
topology-length = Longueur
topology-split = Diviser les arêtes longues
topology-collapse = Réunir les arêtes courtes
topology-off = Non
topology-brush = Part de la brosse
topology-object = Part de l'objet
topology-view = Part de la vue

## Mirror, pressure, masks, history

mirror-heading = Miroir

pressure-heading = Pression
pressure-curve = Courbe de pression
    .tip = Glisser le bout gauche pour le toucher le plus léger, le milieu pour la courbure
pressure-lightest = Minimum
pressure-bend = Courbure
pressure-radius = Rayon
    .tip = Part du rayon au toucher le plus léger
pressure-radius-curve = Courbe de pression du rayon
pressure-radius-bend = Courbure du rayon

mask-heading = Masque
mask-clear = Vider
    .tip = Tout est libre
mask-fill = Remplir
    .tip = Tout est protégé
mask-invert = Inverser
    .tip = Le libre est protégé, le protégé est libre
mask-blur = Flouter
    .tip = Un bord plus doux
mask-sharpen = Durcir
    .tip = Un bord plus net
mask-grow = Étendre
    .tip = Un anneau de sommets de plus
mask-shrink = Réduire
    .tip = Un anneau de moins
mask-cavity = Creux
    .tip = Les creux sont protégés
mask-thin = Parties fines
    .tip = Ce qui a au plus cette épaisseur est protégé
mask-occlusion = Abrité
    .tip = Ce que l’objet prive de lumière est protégé
mask-thin-below = mince
    .tip = Part du plus long côté
mask-note = { $keys } le montre ; la brosse Masque le peint

history-heading = Historique
history-steps = { $at } sur { $all }
history-versions = { $count ->
    [one] { $count } version
   *[other] { $count } versions
}
history-step = Étape
    .tip = Glisser pour parcourir les étapes
history-after = Après l'étape { $step }
history-version = Version
    .tip = Glisser pour parcourir les versions de cette ligne
history-row = Version { $node }, à { $time }
history-row-branch = Version { $node }, à { $time }, sur une branche
history-replaced = remplacé
history-added = ajouté
history-removed = retiré
history-duplicated = dupliqué
history-renamed = renommé
history-moved = déplacé
history-activated = activé
history-shown = montré ou caché
history-locked = verrou changé
history-reshaped = reformé
history-layers = calques
history-sets = groupes de faces
history-mask = masque
history-remesh = taille des triangles
history-snapped = plaqué
history-arranged = réordonné
history-set-named = groupe de faces nommé
history-followed = a suivi ses opérandes
history-applied = booléen appliqué
history-mirrored = miroir
history-boolean = booléenne
history-merged = fusionné
history-split = séparé

## Page: look

look-material = Matériau
material-clay = argile
material-porcelain = porcelaine
material-wax = cire
material-stone = pierre
material-jade = jade
material-bronze = bronze
material-graphite = graphite
material-steel = acier
light-name = Lumière
    .tip = Les images d'environnement (HDR, EXR) et de boules éclairées, carrées, sont gardées quand on les dépose sur la fenêtre
light-studio = Studio
light-room = Pièce
light-matcap = Boule éclairée
light-turned = Rotation
light-raised = Hauteur
light-shadow = Ombres
    .tip = { $action } : ce qui se tient dans la lumière principale assombrit ce qui est derrière
light-bright = Luminosité
reference-name = Référence
    .tip = Déposez sur la fenêtre une image non carrée
reference-none = Aucune
reference-behind = Derrière l'argile
reference-opacity = Opacité
look-facets = Facettes
look-cavity = Cavité
    .tip = Creux plus sombres, arêtes plus claires
look-occlusion = Occlusion
    .tip = { $action } : occlusion ambiante en espace écran
look-wireframe = Fil de fer
look-grid = Grille
look-smooth-edges = Bords lissés
    .tip = Quatre échantillons par pixel ; coûte du temps sans carte graphique
look-map = Carte
map-none = Aucune
    .tip = L'argile elle-même
map-mask = Masque
map-thickness = Épaisseur
map-distance = Distance
look-camera = Caméra
look-orthographic = Orthographique
look-angle = Angle
    .tip = Champ de vision, degrés
look-four-views = Quatre vues
view-top = De dessus
view-free = Libre
view-front = De face
view-right = De droite
view-alone = Montre cette vue seule, comme un double clic à côté de l'argile. « { $action } » y mène et en ramène.
views-no-copies = Les quatre vues demandent un écran où copier des images, ce que ce pilote n'offre pas. Le travail continue dans une seule vue.
look-keep = Garder la vue
    .tip = Garde cette vue sous un numéro, pour y revenir
    .show = Montre à nouveau cette vue ; un clic droit l’oublie
legend-measuring = mesure

## Page: scene

scene-object = Objet
scene-size = { $x } x { $y } x { $z } { $unit }
scene-held = Objet tenu
    .tip = Apparaît à côté de l'objet, pour y être amené
scene-held-note = Prendre une forme, l'amener en place, puis unir, couper ou garder.
scene-add = Unir
    .tip = Les deux n'en font qu'un
scene-cut = Couper
    .tip = L'objet tenu est découpé de l'objet
scene-keep = Intersecter
    .tip = Ne reste que ce qui est dans les deux
scene-put-down = Poser
    .tip = Il devient un objet là où il est
scene-put-away = Ranger
scene-busy = calcul en arrière-plan : continuez à sculpter
scene-preview = Aperçu
scene-computing = calcul ...
scene-shown = { $count } triangles de l'objet tenu
scene-apply = Appliquer
    .tip = Faire ce qui est montré
scene-dismiss = Rejeter
    .tip = L'objet reste tel quel ; l'objet tenu aussi
scene-yaw = lacet
scene-pitch = tangage
scene-roll = roulis
scene-scale = échelle
scene-held-size = taille

objects-heading = Objets
objects-add = Ajouter un objet
objects-duplicate = Dupliquer
objects-rename = Renommer
objects-remove = Retirer
objects-locked = Verrouillé : ni trait, ni déplacement, ni retrait
objects-group = Groupe
    .tip = Nomme le groupe de l’objet ; un nom vide l’en retire
objects-mirror = Miroir
objects-live = Booléens vivants
    .tip = Les opérandes restent cachés et le résultat est recalculé quand l’un d’eux change
objects-follows = Suit ses opérandes
objects-apply = Appliquer
    .tip = Les opérandes partent et le résultat reste tel quel
objects-gizmo = Gizmo
    .tip = Déplace, tourne et redimensionne l’objet au pointeur ; par pas avec Ctrl
objects-snap = Plaquer face contre face
    .tip = Plaque une face plane d’un objet contre celle d’un autre
objects-snap-first = Appuyez sur la face à déplacer
objects-snap-second = Appuyez sur la face où la plaquer
objects-eye = œil
    .tip = Dessiné
objects-lock = verrou
    .tip = Protégé des traits, des déplacements et du retrait
objects-reset-place = Remettre en place
    .tip = Retour là où il a été créé
shape-box = Cube
shape-ball = Sphère
shape-cylinder = Cylindre
shape-cone = Cône
shape-torus = Tore
shape-tube = Tube
shape-plane = Plan
operation-all = Les quatre
    .tip = Union, intersection et les deux différences, chacune un objet
operation-union = Union
    .tip = L'objet actif et celui-ci n'en font qu'un
operation-intersection = Intersection
    .tip = Ne reste que ce qui est dans les deux
operation-difference = Différence
    .tip = Cet objet est découpé de l'actif
operation-reverse-difference = Différence inverse
    .tip = L'actif est découpé de celui-ci

sets-heading = Groupes de faces
sets-eye-tip = Afficher ou masquer le groupe de faces
sets-colours = Montrer en couleurs
sets-isolate = seul
    .tip = Cache tout sauf ce groupe
sets-draw = dessiner
    .tip = Prend la brosse qui dessine ce groupe
sets-none = hors groupe : { $count }
sets-row = groupe { $number } : { $count }
sets-hide-masked = Cacher le masqué
    .tip = Cache ce qui est masqué au moins à moitié
sets-invert = Inverser le visible
    .tip = Cache le visible et affiche le caché
sets-show-all = Tout afficher
    .tip = Plus rien n’est caché
sets-clear = Vider les groupes
    .tip = Aucun sommet n’est plus dans un groupe ; le caché reste caché
sets-from-mask = Depuis le masque
    .tip = Ce qui est masqué au moins à moitié devient un groupe
sets-from-visible = Depuis le visible
    .tip = Tout ce qui est visible devient un groupe
sets-loose = Parties séparées
    .tip = Chaque partie d’un seul tenant devient un groupe
sets-normals = Par direction
    .tip = Chaque partie tournée à peu près du même côté devient un groupe
sets-crease = Par arêtes
    .tip = Les groupes se rejoignent là où la surface plie plus que l’angle
sets-degrees = Angle
sets-thickness = Épaisseur
    .tip = Part du plus long côté ; sous 0 vers l’intérieur
sets-extract-mask = Extraire le masque
    .tip = Ce qui est masqué devient un objet : une coque fermée de cette épaisseur
sets-extract-name = extrait

layers-heading = Calques
layers-add = Ajouter un calque
    .tip = Les traits vont au nouveau calque
layers-name = calque { $number }
layers-base = base
    .tip = Les traits restent sous tous les calques
layers-unseen = Le calque actif est caché ou son intensité est 0 : les traits ne se verraient pas
layers-topology = La topologie dynamique repose tant que l'objet a des calques ; fusionnez-les pour l'utiliser
layers-eye = œil
    .tip = Visible
layers-up = Monter
    .tip = Au-dessus du calque suivant
layers-down = Descendre
    .tip = Au-dessous du calque suivant
layers-merge = Fusionner vers le bas
    .tip = L'ajoute au calque du dessous, ou à la base. Les deux doivent être visibles
layers-duplicate = Dupliquer calque
    .tip = Un jumeau caché au-dessus
layers-clear = Vider calque
    .tip = Enlève ce qu'il fait
layers-remove = Retirer calque
    .tip = Le retire avec ce qu'il fait
layers-rename = Renommer calque
layers-bake = Tout fusionner
    .tip = La surface telle quelle devient la base

levels-heading = Niveaux
levels-at = niveau { $at } sur { $all }, { $count } triangles
levels-coarser = Grossier
    .tip = Former l'ensemble ; le détail des niveaux fins suit
levels-finer = Plus fin
    .tip = Quatre triangles pour chacun
    .back = Retour au niveau plus fin

remesh-heading = Remaillage
remesh-own = Voxel choisi
    .tip = Sinon les nouveaux triangles sont à peu près aussi grands que les actuels
remesh-voxel = voxel
remesh-along = { $count } sur le plus long côté
remesh-sharp = Garder les arêtes vives
remesh-button = Remailler
    .tip = Une surface de triangles égaux ; les parties superposées n'en font qu'une. { $keys }
remesh-local-heading = Sur place
remesh-local-edge = Longueur d’arête
    .tip = Fois la longueur d’arête habituelle de l’objet
remesh-local-undo = { $keys } l’annule à tout moment, même en cours.
remesh-stretched = Affiner ce qui est étiré
    .tip = Divise les arêtes trop longues de tout l’objet ; ce qui est masqué ou caché reste

quads-heading = Quadrilatères
quads-count = quadrilatères
quads-levels = niveaux plus fins
    .tip = Les quadrilatères sont le niveau le plus bas ; les niveaux plus fins rendent le détail
quads-button = Remailler en quadrilatères
    .tip = Des quadrilatères qui suivent la forme ; un export sans niveaux les écrit

decimate-heading = Décimation
decimate-share = des triangles
decimate-button = Décimer
    .tip = Moins de triangles, pour l'impression et le web. Aucune nouvelle auto-intersection, et le bord du masque reste

trim-heading = Rognage
trim-box = Cadre
    .tip = Glisser un cadre sur la vue : ce qui s'y trouve est coupé de part en part
trim-line = Ligne
    .tip = Glisser une ligne sur la vue : ce qui est à sa gauche est coupé
trim-note = Glisser sur la vue ; Échap annule.

region-heading = Région de la vue
region-draw = Région :
region-lasso = Lasso
    .tip = Glisser autour de ce qui est visé
region-box = Cadre
    .tip = Glisser d’un coin à l’autre
region-line = Ligne
    .tip = Glisser une ligne : ce qui est à sa gauche est visé
region-polyline = Polyligne
    .tip = Cliquer coin par coin
region-front = Faces avant seulement
    .tip = Seulement ce qui vous fait face ; sinon de part en part
region-mask = Masquer
    .tip = Protège ce qui est dans la région ; avec Ctrl : le libère
region-unmask = Démasquer
    .tip = Libère ce qui est dans la région ; avec Ctrl : le protège
region-hide = Cacher
    .tip = Cache ce qui est dans la région ; avec Ctrl : tout le reste
region-isolate = Montrer seul
    .tip = Cache tout le reste ; avec Ctrl : ce qui est dans la région
region-face-set = Groupe
    .tip = Ce qui est dans la région devient un nouveau groupe
region-remesh = Taille des triangles
    .tip = Les triangles de la région reçoivent cette longueur d’arête, à travers tout l’objet
region-done = Terminé
    .tip = Arrête le dessin de régions (Échap)
region-note = Glisser sur la vue. Ctrl inverse, Échap termine.
region-polyline-note = Cliquer chaque coin ; encore le premier ou le dernier, ou Entrée, ferme.

menu-add = unir
menu-carve = creuser
menu-keep = garder le commun
menu-put-away = ranger
menu-ball = sphère
menu-box = cube
menu-cylinder = cylindre
menu-undo = annuler
menu-redo = refaire
menu-pick-up = prendre

## Page: walls

walls-heading = Épaisseur des parois
walls-live = Carte en direct
walls-process = Procédé
walls-own-limit = limite propre
walls-too-thin-below = Trop mince sous
walls-note = Presser { $keys } : la carte suit l'argile pendant que vous sculptez.
walls-thinnest = minimum
walls-median = médiane
walls-thickest = maximum
walls-too-thin = trop mince
walls-measured = mesuré
walls-spots = Points minces
walls-none = Aucun sous la limite.
walls-spot = { $number } : { $value } mm
    .tip = La caméra y vole
walls-histogram = Histogramme d'épaisseur
    .tip = { $min } à { $max } mm ; le trait est la limite
process-abs = Moulage par injection, ABS
process-fdm = Filament fondu (FDM)
process-pa = Moulage par injection, polyamide (PA)
process-pc = Moulage par injection, polycarbonate (PC)
process-pom = Moulage par injection, acétal (POM)
process-pp = Moulage par injection, polypropylène (PP)
process-sla = Stéréolithographie (SLA)
process-sls = Frittage laser (SLS)

## Page: size

measure-heading = Mesures
measure-waits = Mesuré quand rien ne change.
measure-volume = volume
measure-area = aire
measure-size = taille { $axis }
measure-shadow = ombre { $axis }
measure-stale = D'un état antérieur ; mesuré à nouveau quand rien ne change.
shadow-heading = Ombre
shadow-along = ombre selon { $axis }
    .tip = Vue selon { $axis }
shadow-here = D'ici
    .tip = Vue comme la caméra
shadow-size = { $x } x { $y } mm, { $holes } trous
shadow-file = Dessin à écrire
    .tip = Le fichier du dessin
shadow-write = SVG
    .tip = Le contour en dessin à l'échelle, millimètres
shadow-outline = Contour de l'ombre
distance-heading = Distance
distance-live = Carte des distances
distance-before = à avant
    .tip = À l'objet tel qu'il a été ouvert
distance-held = à l'objet tenu
distance-now = Comparer à maintenant
    .tip = Les distances sont mesurées à l'objet tel qu'il est maintenant
distance-note = Le bleu est dedans, le rouge dehors.
distance-deepest = plus bas
distance-highest = plus haut
distance-rms = rms
distance-known = connu

## Page: files

files-open = Ouvrir
    .note = Déposer un maillage sur la fenêtre, ou :
files-open-name = Fichier à ouvrir
files-browse = Parcourir...
files-recent = Récents
files-earlier = Sculptures antérieures
files-export = Exporter
files-export-name = Fichier à écrire
files-scale = Échelle
files-unit = Unité
unit-pixel = px
unit-mm = mm
unit-cm = cm
unit-m = m
unit-inch = pouces
files-save-as = Enregistrer sous...
files-pictures = Images
files-screenshot = Capture d'écran
files-turntable = Tour complet
files-frames = images
files-replace = Remplacer
    .question = { $path } existe. Le remplacer ?

chooser-open = Ouvrir un maillage
chooser-export = Exporter la sculpture
chooser-meshes = Maillages
chooser-home = Personnel
chooser-documents = Documents
chooser-downloads = Téléchargements
chooser-desktop = Bureau
chooser-up = Monter
chooser-reading = lecture...
chooser-empty = ni dossier ni fichier de maillage ici
chooser-name = Nom

start-heading = Continuer avec
start-note = Cette nouvelle sculpture est enregistrée au fil du travail.
start-stay = Rester ici
start-session = { $object }, { $date } { $time }

## Page: pens

devices-heading = Appareils
devices-none = Aucune tablette trouvée : branchez-en une, sans rien relancer.
    .mouse = La souris sculpte aussi : les traits lents appuient plus fort.
devices-camera = Caméra
    .privacy = Les images restent dans ce programme et ne sont pas enregistrées.
devices-in-range = À portée maintenant
devices-pointer = pointeur
devices-tablet = tablette { $number }
devices-serial = stylet série { $number }
devices-recording = enregistrement { $number }
devices-demo = stylet de démo { $number }
devices-pen = stylet { $number }
devices-eraser = { $pen }, gomme
devices-no-tilt = sans inclinaison
devices-tilt = inclinaison { $x }, { $y } degrés
devices-pressure = pression { $pressure }, { $tilt }
devices-place = à { $x } %, { $y } % de la vue
devices-hands = { $count ->
    [one] une main suivie
   *[other] { $count } mains suivies
}
devices-strain = effort du bras { $percent } %
devices-rest = Le bras travaille haut : reposez-le, ou travaillez plus bas.
devices-nothing = rien
devices-curve = La courbe de pression à gauche montre la trace du stylet en direct.
pose-neutral = Neutre
pose-point = Index
pose-pinch = Pincement
pose-grab = Poing
pose-flat = Plate
pose-open = Ouverte

tablet-heading = Touches de la tablette
tablet-choose = Choisir en la pressant
    .tip = Puis presser la touche de la tablette ou le bouton du stylet, ou tourner l'anneau. Elle ne fait rien d'autre entre-temps
tablet-listening = Presser une touche...
tablet-usual = Comme d'habitude ({ $action })
tablet-action = Action de { $control }
tablet-line = { $control } : { $action }
tablet-reset = Réinitialiser
    .tip = De nouveau comme d'habitude
tablet-none = Tout fait ce qu'il fait d'habitude.
tablet-nothing = Rien
tablet-next-mode = Mode suivant
tablet-radius = Rayon
    .back = Rayon, à l'envers
tablet-strength = Force
    .back = Force, à l'envers
tablet-turn = Tourner la vue, maintenu
tablet-slide = Glisser la vue, maintenu
tablet-zoom = Zoom, maintenu
tablet-radius-and-strength = Rayon et force en glissant
tablet-carve = Creuser, maintenu
tablet-brush = Brosse { $brush }
    .held = Brosse { $brush }, maintenu
control-key = Touche { $number }
control-barrel = Bouton { $number }
control-eraser = Gomme
control-wheel = Molette { $number }
control-ring = Anneau { $number }
control-strip = Bande { $number }

## Page: loop

loop-heading = Boucle
loop-tick = cycle
loop-late = en retard
loop-samples = relevés
loop-dabs = touches
loop-lost = perdus
    .note = perdus : mouvement + contacts
loop-window = Cette fenêtre
loop-frames = images/s
loop-frame = image
loop-worst = pire
loop-to-clay = à l'argile
loop-to-screen = à l'écran
    .note = à l'argile, à l'écran : depuis le dernier relevé
loop-in-view = en vue
loop-of = { $part } sur { $all }
loop-uploaded = envoyé
loop-object = Objet
loop-vertices = sommets
loop-triangles = triangles
loop-saved = enregistré au fil du travail : { $path }
loop-sample-to-screen = Du relevé à l'écran
loop-up-to = jusqu'à { $value } ms
loop-longer = plus long
loop-class = { $class } : { $count }
loop-histogram = { $frames } images ; { $first } ms, et le double à chaque barre
stage-tick = cycle
    .about = de la lecture à la fin du cycle qui l'a pris
stage-wait = attente
    .about = de la fin de ce cycle au début d'une image
stage-draw = dessin
    .about = du début de l'image à sa remise
stage-present = affichage
    .about = de la remise à la présentation
stage-total = total
    .about = de la lecture à la présentation

## Page: more

preferences-heading = Préférences
preferences-language = Langue
preferences-language-system = Du système ({ $name })
preferences-font = { $name } demande une police qui manque à cet ordinateur. Installez-en une avec ses lettres, comme Noto Sans CJK, et choisissez à nouveau la langue.
preferences-text-size = Texte
preferences-light = Panneaux clairs
preferences-speed = La vitesse est pression
    .tip = Pour une souris : les traits lents appuient plus que les rapides
preferences-lead = Montrer le trait en avance sur le stylet
    .tip = Ce que le stylet aura soulevé quand l’image sera vue ; l’argile elle-même ne dépend que du stylet
preferences-fingers = Deux doigts
    .tip = Sur un écran tactile. Pincés ils zooment ; trois doigts font l'autre, toucher à trois annule, à quatre refait
preferences-fingers-turn = Tourner
preferences-fingers-slide = Glisser
preferences-lesson-skip = Passer la leçon
preferences-lesson-again = Revoir la première leçon
preferences-keys = Touches...
preferences-help = Aide
preferences-search = Chercher une action
preferences-no-session = Sans fichier de session : la sculpture n'est gardée que si vous l'exportez.

messages-heading = Messages
messages-loading = Chargement de { $name }

## The window of the keys

keys-heading = Touches
keys-set = Jeu
keys-as-in-set = Comme dans le jeu
    .tip = Oublie toute touche que vous avez changée
keys-find = Chercher
keys-note = Cliquez sur les touches d'une action pour les changer.
keys-shared = { $count ->
    [one] { $count } action partage ses touches avec une autre
   *[other] { $count } actions partagent leurs touches avec une autre
}
keys-press = Presser...
keys-of = Touches de { $action }
    .tip = Cliquer, puis presser les nouvelles touches. Échap les laisse, Suppr les retire
keys-also = aussi : { $actions } (la choisie l'emporte)
    .own = aussi : { $actions } (celle-ci est faite)
keys-unknown-action = keys.own : aucune action ne s'appelle "{ $id }"
keys-unreadable = keys.own.{ $id } : "{ $keys }" n'est pas une touche : attendu par exemple Z, F12, [ ou Ctrl+Shift+Z

## Search, radial menu, dragged settings, curves

search-heading = Chercher une action
search-nothing = rien ne s'appelle ainsi

radial-radius = Rayon
radial-mirror = Miroir x
radial-thickness = Épaisseur
radial-frame = Cadrer
radial-strength = Force
radial-carve = Creuser

modal-radius = Rayon { $value } : clic pour garder, Échap pour laisser tel quel
modal-strength = Force { $value } : clic pour garder, Échap pour laisser telle quelle

curve-note = Dessiner ou poser des points : ils se changent avant que la brosse suive.
curve-points = { $count ->
    [one] { $count } point
   *[other] { $count } points
}
curve-draw = Tracer la courbe
    .tip = La brosse la suit, en une seule étape (Entrée)
curve-remove = Retirer le point
    .tip = Suppr, ou le bouton droit dessus
curve-discard = Rejeter
    .tip = Rien n'est tracé (Échap)

## The first lesson

lesson-demo = La démonstration tourne. Touchez l'argile quand vous voulez
lesson-line = { $hint } ({ $at } sur { $all })
lesson-sculpt = Pressez et glissez sur l'argile
lesson-turn = Glissez à côté de l'argile pour la tourner, molette pour zoomer
lesson-smooth = Tenez Maj et repassez sur ce que vous avez fait : cela s'adoucit
lesson-carve = Tenez Ctrl et tracez : cela creuse au lieu d'élever
lesson-undo = { $keys } annule le dernier trait
lesson-mirror = { $keys }, ou x sous Miroir à gauche, et un trait : les deux côtés
    .no-keys = Choisissez x sous Miroir à gauche, et faites un trait : les deux côtés

## Help

help-heading = Aide
help-pages = Pages à droite
help-keys = Touches
help-pen = Stylet ou souris
help-pen-press = Presser et glisser sur l'argile
    .does = Sculpter
help-pen-carve = De même avec Ctrl ou Alt
    .does = Creuser au lieu d'élever, pour un trait
help-pen-smooth = De même avec Maj
    .does = Adoucir, pour un trait
help-pen-turn = Glisser à côté de l'argile, ou avec le bouton droit
    .does = Tourner la vue
help-pen-slide = Bouton central, ou droit avec Maj
    .does = Glisser la vue
help-pen-zoom = Molette
    .does = S'approcher de ce qui est sous le pointeur
help-pen-menu = Tenir Espace
    .does = Menu autour du pointeur
help-fingers = Doigts sur un écran
help-fingers-one = Un doigt sur l'argile
    .does = Sculpter
help-fingers-two = Deux doigts
    .does = Tourner la vue ; pincés ils zooment
help-fingers-three = Trois doigts
    .does = Glisser la vue (la page Plus échange les deux)
help-fingers-tap = Toucher à trois, à quatre
    .does = Annuler, refaire
help-hands = Mains nues au-dessus d'un capteur
help-hands-index = Index tendu
    .does = Le bout du doigt pousse l'argile
help-hands-pinch = Pouce et index fermés
    .does = Tenir l'argile, la porter, la lâcher
help-hands-flat = Doigts tendus et joints
    .does = La paume presse et adoucit
help-hands-open = Doigts tendus et écartés
    .does = Tourner la vue ; à deux mains, zoomer
help-hands-fist = Poing
    .does = Glisser la vue
help-hands-both = Pincer des deux mains
    .does = Tenir la sculpture : tourner, déplacer, agrandir
help-hands-menu = Un doigt reste dans une sphère à gauche
    .does = Choisir dans le menu des mains
help-work = Le travail est gardé
help-work-close = Fermer la fenêtre à tout moment
    .does = La session reprend là où elle en était
help-work-files = Page Fichiers
    .does = Ouvrir, exporter, sculptures antérieures

## Actions

action-brush = Brosse { $brush }
action-page = Page : { $page }
action-undo = Annuler
action-redo = Refaire
action-carve = Creuser ou élever
action-larger = Brosse plus grande
action-smaller = Brosse plus petite
action-stronger = Brosse plus forte
action-weaker = Brosse plus faible
action-drag-radius = Glisser le rayon
action-drag-strength = Glisser la force
action-sample-colour = Prélever la couleur
action-mirror-x = Miroir en x
action-mirror-y = Miroir en y
action-mirror-z = Miroir en z
action-frame = Cadrer la sculpture
action-front = Vue de face
action-back = Vue de derrière
action-left = Vue de gauche
action-right = Vue de droite
action-top = Vue de dessus
action-bottom = Vue de dessous
action-perspective = Perspective ou orthographique
action-four-views = Quatre vues ou une
action-next-material = Matériau suivant
action-facets = Ombrage lisse ou plat
action-ssao = Occlusion ambiante
action-shadows = Ombres
action-wireframe = Fil de fer
action-grid = Grille
action-thickness = Carte d'épaisseur
action-mask = Carte du masque
action-distance = Carte des distances
action-trim-box = Rogner par un cadre
action-trim-line = Rogner par une ligne
action-region-lasso = Région au lasso
action-region-box = Région par un cadre
action-region-line = Région par une ligne
action-region-polyline = Région par une polyligne
action-region-mask = Masquer une région
action-region-unmask = Démasquer une région
action-region-hide = Cacher une région
action-region-isolate = Montrer seule une région
action-region-face-set = Groupe d’une région
action-finer = Niveau plus fin
action-coarser = Niveau plus grossier
action-remesh = Remailler
action-try-add = Aperçu : unir l'objet tenu
action-try-cut = Aperçu : couper avec l'objet tenu
action-try-keep = Aperçu : garder le commun
action-open-mesh = Ouvrir un maillage
action-export = Exporter le maillage
action-screenshot = Capture d'écran
action-turntable = Images du tour complet
action-search = Chercher une action
action-panels = Panneaux
action-light-or-dark = Clair ou sombre
action-larger-text = Texte plus grand
action-smaller-text = Texte plus petit
action-help = Aide
action-keys = Changer les touches
action-lesson = Première leçon

## Messages of background tasks

task-loaded = { $name } : { $count } sommets
task-exported = Enregistré { $path } : { $x } x { $y } x { $z } { $unit }
task-saved = Enregistré { $path }
task-frames = { $frames } images enregistrées dans { $folder }
task-failed = { $path } : { $error }
task-done = { $operation } : fait
task-snapped = Les faces sont l’une contre l’autre
task-mirrored = Un jumeau en miroir a été ajouté
task-trimmed = Rogné
task-level = Niveau { $at } sur { $all }
task-remesh-local = Arêtes changées : { $count }
task-remesh-taken-back = Le remaillage a été annulé avant d’être terminé.
task-remeshed = Remaillé : { $count } triangles, voxels de { $voxel }, volume { $change } %; intersections : { $crossings }
task-remesh-lost = Des parties plus fines qu’un voxel sont perdues, par exemple en { $x }, { $y }, { $z } : annulez et prenez un voxel plus petit
task-quads = { $quads } quadrilatères et { $triangles } triangles ; intersections : { $crossings }
task-decimated = { $before } triangles sont devenus { $now } ; nouvelles intersections : { $crossings }
task-layers-baked = Calques fusionnés dans la nouvelle surface : { $count }
task-sets-made = Groupes de faces créés
task-mask-measured = Masqués : { $count } sommets
task-sets-dropped = Les groupes de faces ont disparu avec l’ancienne surface ; plus rien n’est caché
task-extracted = Objet de { $count } sommets extrait
task-preferences-unreadable = { $path } : { $error } ; il est gardé sous { $aside }
task-preferences-stuck = { $path } : { $error } ; il ne peut être mis de côté : { $why }
task-brush-saved = La brosse { $name } est enregistrée
task-brush-not-saved = La brosse n'est pas enregistrée : { $error }
task-picture-kept = Gardée sous { $path }
task-preferences-unread = { $path } : les préférences ne peuvent être lues : { $error }
task-preferences-not-kept = { $path } : les préférences ne sont pas gardées : { $error }
language-unreadable = { $path } : { $error }

## People who share the sculpture

people-heading = Personnes
people-you = { $name } (vous)
people-gone = Partis : { $names }
people-sculptor = sculpteur
people-viewer = spectateur
people-device = appareil
people-invite = Inviter par un code
people-invite-about = Scannez-le avec un téléphone ou une tablette de ce réseau, ou ouvrez le lien : on sculpte dans le navigateur.
people-invite-copy = Copier le lien
undo-in-the-way = Non annulé : { $name } a modifié le même endroit depuis. Ce sera possible quand { $name } l'aura annulé.
redo-in-the-way = Non rétabli : { $name } a modifié le même endroit depuis. Ce sera possible quand { $name } l'aura annulé.
