# What the window says in Greek; config/languages/en/window.ftl holds the English of every message.

language-name = Ελληνικά
    .latin = Ellinika

## Keys that are held with another one

key-ctrl = Ctrl
key-alt = Alt
key-shift = Shift

## Words that many places share

off = ανενεργό
none = κανένα
cancel = Άκυρο
reset = Επαναφορά
undo = Αναίρεση
redo = Επανάληψη
open = Άνοιγμα
export = Εξαγωγή
length-mm = { $value } mm
area-mm2 = { $value } mm²
volume-mm3 = { $value } mm³
time-ms = { $value } ms
percent = { $value } %
size-bytes = { $value } B
size-kilobytes = { $value } kB
size-megabytes = { $value } MB
triangles = { $count } τρίγωνα
both-keys = { $first } και { $second }
name-with-keys = { $name } ({ $keys })

## Pages at the right

page-look = Όψη
    .about = Πώς φαίνεται ο πηλός
page-scene = Σκηνή
    .about = Δεύτερο αντικείμενο, πράξεις Boolean, επίπεδα λεπτομέρειας, περικοπή
page-walls = Τοιχώματα
    .about = Πάχος τοιχωμάτων και λεπτά σημεία
page-measure = Μεγέθη
    .about = Μετρήσεις, σκιά κατά μία διεύθυνση, αποστάσεις από άλλη μορφή
page-files = Αρχεία
    .about = Άνοιγμα, εξαγωγή, εικόνες
page-devices = Πένες
    .about = Συσκευές και οι τρέχουσες τιμές τους
page-loop = Βρόχος
    .about = Χρόνοι του βρόχου υπολογισμού και αυτού του παραθύρου
page-more = Άλλα
    .about = Γλώσσα, προτιμήσεις και μηνύματα

## Brushes

kind-gaussian = Γκαουσιανή
    .about = Υψώνει μια καμπάνα πηλού κατά την κάθετο της επιφάνειας (Cipollini 2020).
kind-smooth = Λείανση
    .about = Εξομαλύνει την επιφάνεια: λαπλασιανή με βάρη συνεφαπτομένης· η δύναμη είναι το μέρος της διαδρομής ανά πινελιά.
kind-draw = Σχεδίαση
    .about = Υψώνει την επιφάνεια κατά τη μέση κάθετό της, σύμφωνα με την εξασθένιση.
kind-clay = Πηλός
    .about = Προσθέτει πηλό σε επίπεδη στρώση: γεμίζει ως ένα επίπεδο λίγο πάνω από την επιφάνεια.
kind-clay-strips = Λωρίδες πηλού
    .about = Απλώνει πηλό σε επίπεδες λωρίδες με τετράγωνα άκρα, στραμμένες κατά την κίνηση.
kind-inflate = Φούσκωμα
    .about = Φουσκώνει τη μορφή: κάθε κορυφή κατά τη δική της κάθετο.
kind-layer = Στρώση
    .about = Μία στρώση ίσου ύψους ανά κίνηση, όσες φορές κι αν περάσει.
kind-crease = Πτύχωση
    .about = Χαράζει αυλάκι με πλευρές που πλησιάζουν· αρνητικά υψώνει ράχη.
kind-pinch = Τσίμπημα
    .about = Τραβά την επιφάνεια προς το μέσο του πινέλου· αρνητικά την απλώνει.
kind-blob = Σταγόνα
    .about = Υψώνει στρογγυλή σταγόνα: η επιφάνεια φουσκώνει από ένα σημείο κάτω της.
kind-flatten = Ισοπέδωση
    .about = Φέρνει λόφους και κοιλότητες στο μέσο επίπεδο· αρνητικά τα βαθαίνει.
kind-fill = Γέμισμα
    .about = Γεμίζει κοιλότητες ως το μέσο επίπεδο και αφήνει τους λόφους· αρνητικά κατεβάζει τους λόφους.
kind-scrape = Ξύσιμο
    .about = Κατεβάζει λόφους ως το μέσο επίπεδο και αφήνει τις κοιλότητες· αρνητικά γεμίζει τις κοιλότητες.
kind-trim = Περικοπή
    .about = Κόβει ό,τι ξεπερνά ένα επίπεδο λίγο κάτω από την επιφάνεια, σαν μαχαίρι.
kind-grab = Άρπαγμα
    .about = Ό,τι ήταν κάτω από το πινέλο όταν κατέβηκε η πένα ακολουθεί την πένα.
kind-elastic = Ελαστικό
    .about = Κινεί τον πηλό σαν ελαστικό σώμα πιασμένο σε ένα σημείο (κανονικοποιημένα Kelvinlets, de Goes και James 2017).
kind-topological = Τοπολογικό
    .about = Όπως το άρπαγμα, αλλά πιάνει ό,τι είναι κοντά πάνω στην επιφάνεια, όχι μέσα από τον αέρα.
kind-snake-hook = Γάντζος
    .about = Τραβά πηλό πίσω από την πένα και την ακολουθεί.
kind-twist = Συστροφή
    .about = Στρέφει ό,τι ήταν κάτω από το πινέλο γύρω από την κάθετο, καθώς η πένα πάει δεξιά.
kind-thumb = Αντίχειρας
    .about = Απλώνει πάνω στην επιφάνεια ό,τι ήταν κάτω από το πινέλο.
kind-nudge = Ώθηση
    .about = Σπρώχνει την επιφάνεια μαζί με την κίνηση.
kind-relax = Χαλάρωση
    .about = Εξισώνει τα τρίγωνα πάνω στην επιφάνεια και αφήνει τη μορφή.
kind-mask = Μάσκα
    .about = Προστατεύει από άλλα πινέλα ό,τι βάφει· αρνητικά το ελευθερώνει.
kind-mask-blur = Θόλωμα μάσκας
    .about = Μαλακώνει τα όρια της μάσκας· αρνητικά τα οξύνει.
kind-paint = Βαφή
    .about = Απλώνει το χρώμα του πινέλου στον πηλό.
kind-texture = Υφή
    .about = Αποτυπώνει ένα άλφα ως ανάγλυφο κατά την κίνηση, λυγισμένο όπως αυτή και επαναλαμβανόμενο.
kind-density = Πυκνότητα
    .about = Φέρνει τα τρίγωνα στο ζητούμενο μέγεθος, μέρος του πινέλου, και τα εξισώνει· η μορφή μένει.
kind-simplify = Απλοποίηση
    .about = Ενώνει μικρά τρίγωνα ως το ζητούμενο μέγεθος, μέρος του πινέλου· τα μεγάλα και η μορφή μένουν.
kind-slide-relax = Ολίσθηση
    .about = Ολισθαίνει τα τρίγωνα πάνω στην επιφάνεια με την κίνηση και αφήνει τη μορφή· με Shift, ή ανάποδα, τα χαλαρώνει.
kind-plane = Επίπεδο
    .about = Φέρνει λόφους και κοιλότητες στο μέσο επίπεδο της επιφάνειας όπως τη βρήκε η κίνηση· αρνητικά τα βαθαίνει.
kind-multiplane-scrape = Διπλό ξύσιμο
    .about = Ξύνει δύο επίπεδα που συναντιούνται κατά την κίνηση, ώστε να μείνει ράχη με επίπεδες πλευρές.
kind-sharpen = Όξυνση
    .about = Τονίζει το λεπτό ανάγλυφο· αρνητικά το μειώνει.
kind-surface-smooth = Λεία επιφάνεια
    .about = Εξομαλύνει την επιφάνεια και κρατά τον όγκο της (Taubin 1995).
kind-boundary = Όριο
    .about = Το όριο μιας ανοιχτής επιφάνειας ακολουθεί την πένα, και μαζί η επιφάνεια πίσω του.
kind-erase-layer = Σβήσιμο στρώσης
    .about = Αφαιρεί ό,τι κάνει η ενεργή στρώση· η επιφάνεια επιστρέφει σε ό,τι είναι από κάτω.
kind-draw-face-sets = Σχεδίαση ομάδων
    .about = Σχεδιάζει ομάδες όψεων: κάθε πινελιά μία νέα· αρνητικά συνεχίζει την ομάδα όπου άρχισε.

## Numbers of single brushes

number-depth = βάθος
    .blob = πόσο κάτω από την επιφάνεια βρίσκεται το σημείο, σε ακτίνες
    .plane = πόσο κάτω από το επίπεδο φτάνει η ζώνη, σε ακτίνες
    .trim = πόσο κάτω από την επιφάνεια κόβει, σε ακτίνες, με όλη τη δύναμη
number-lift = ανύψωση
    .about = πόσο πάνω από την επιφάνεια στέκει το επίπεδο, σε ακτίνες, με όλη τη δύναμη
number-fill = γέμισμα
    .about = το μέρος της διαδρομής προς το επίπεδο ανά πέμπτο της ακτίνας
number-roundness = στρογγυλότητα
    .about = 0 τετράγωνο, 1 δίσκος
number-pinch = τσίμπημα
    .about = πόσο πλησιάζουν οι πλευρές
number-poisson = Poisson
    .about = πόσο κρατά ο πηλός τον όγκο του: 0.5 εντελώς
number-offset = μετατόπιση
    .about = πόσο μετακινείται το επίπεδο κατά την κάθετό του, σε ακτίνες
number-angle = γωνία
    .about = ανάμεσα στις καθέτους των επιπέδων, σε μοίρες
number-height = ύψος
    .about = πόσο πάνω από το επίπεδο φτάνει η ζώνη, σε ακτίνες
number-scale = κλίμακα
    .about = μήκος μίας επανάληψης, σε πλάτη του πινέλου
number-floor = στάθμη
    .about = το ύψος του άλφα που μένει στην επιφάνεια· ό,τι είναι χαμηλότερο πιέζεται μέσα
number-width = πλάτος
    .about = πλάτος του άλφα σε πλάτη πινέλου: κάτω από 1 επαναλαμβάνεται, πάνω από 1 κόβεται
number-set = ομάδα
    .about = ο αριθμός της ομάδας που σχεδιάζεται· 0: κάθε πινελιά αρχίζει μία νέα

## The brush's settings

brush-more = Άλλα πινέλα
brush-now = Πινέλο: { $name }
brush-favourites = Αγαπημένα
brush-favourite = Αγαπημένο
    .tip = Στέκεται πρώτο ανάμεσα στα πινέλα
brush-own = Δικά σας
    .tip = { $what } (ξανά: όπως αποθηκεύτηκε)
brush-own-about = { $kind }: { $about }
brush-radius = Ακτίνα
    .tip = Με πλήρη πίεση ({ $keys }, ή { $drag } και σύρσιμο)
brush-radius-pixels = Ακτίνα σε εικονοστοιχεία
    .tip = Το πινέλο κρατά το μέγεθός του στην οθόνη καθώς ζουμάρει η όψη· ανενεργό: το μέγεθός του στο αντικείμενο
brush-strength = Δύναμη
    .tip = Πόσο κάνει μία πινελιά ({ $keys }, ή { $drag } και σύρσιμο)
brush-carve = Σκάψιμο
    .tip = { $action }· κρατήστε Ctrl για μία κίνηση
brush-stroke = Κίνηση
brush-settings = Άλλες ρυθμίσεις
brush-dab = Μορφή της πινελιάς
brush-stamp = Άλφα και σφραγίδα
brush-automasks = Αυτόματες μάσκες
brush-topology = Δυναμική τοπολογία
brush-save = Αποθήκευση αυτού του πινέλου
    .tip = Στέκεται ανάμεσα στα δικά σας, με όλες τις ρυθμίσεις και την εικόνα του
brush-save-name = Όνομα
brush-save-new = Αποθήκευση
brush-save-replace = Αντικατάσταση
brush-save-wrong = Έως 64 γράμματα, ψηφία, κενά, - και _, και όχι όνομα πινέλου του προγράμματος

stroke-spacing = Απόσταση
    .tip = Απόσταση των πινελιών ως μέρος της ακτίνας
stroke-stabilizer = Σταθεροποίηση
    .tip = Το πινέλο ακολουθεί την πένα σε αυτή την απόσταση: μέρος του ύψους της όψης
stroke-steadiness = Σταθερότητα
    .tip = Μήκος του νήματος με το οποίο το πινέλο ακολουθεί την πένα, σε ακτίνες
stroke-average = Δείγματα για μέσο όρο
    .tip = Το πινέλο πηγαίνει στον μέσο όρο τόσων δειγμάτων της πένας
stroke-jitter = Διασπορά
    .tip = Πόσο σκορπίζονται οι πινελιές γύρω από τη διαδρομή, σε ακτίνες
stroke-seed = Σπόρος διασποράς:
stroke-method = Μέθοδος
stroke-continuous = Συνέχεια όσο η πένα ακινητεί
stroke-ticks = Χτύποι ανάμεσα σε πινελιές
stroke-compensate = Ίδια δύναμη σε κάθε απόσταση
    .tip = Η δύναμη μετρά στη διαδρομή της πένας· ανενεργό: κάθε πινελιά την έχει όλη
stroke-accumulate = Συσσώρευση
    .tip = Μια κίνηση χτίζει πάνω σε ό,τι ύψωσε η ίδια
stroke-limit = Όριο κίνησης
    .tip = Πόσο μπορεί μια κίνηση να μετακινήσει ένα σημείο, σε ύψη μιας πλήρους πινελιάς· 0: χωρίς όριο

method-space = Ίσες αποστάσεις
method-dots = Κουκκίδες
method-airbrush = Αερογράφος
method-anchored = Αγκυρωμένη
method-drag-dot = Συρόμενη κουκκίδα
method-line = Γραμμή
method-curve = Καμπύλη με σημεία

dab-falloff = Εξασθένιση
dab-curve-tip = Στα { $eighths } όγδοα της ακτίνας
dab-hardness = Σκληρότητα
    .tip = Μέρος της ακτίνας όπου το πινέλο δρα πλήρως
dab-smoothing = Λείανση
    .tip = Κάθε πινελιά λειαίνεται με αυτή τη δύναμη
dab-averaging = Μέσος όρος
    .tip = Μέρος της ακτίνας όπου υπολογίζεται το μέσο επίπεδο της επιφάνειας
dab-plane-trim = Όριο επιπέδου
    .tip = Ό,τι είναι μακρύτερα από το επίπεδο μένει, σε ακτίνες· 0: τίποτα
dab-tilt = Κλίση
    .tip = Πόσο γέρνει μια πινελιά μαζί με την πένα
dab-colour = Χρώμα

colour-sample = Λήψη
    .tip = { $action }: το επόμενο κλικ στον πηλό παίρνει το χρώμα του
colour-sample-here = Κλικ στο χρώμα του πηλού
colour-keep = Κράτημα
    .tip = Το χρώμα στέκεται από εδώ και πέρα παρακάτω
colour-swatch = Χρώμα { $code }
    .tip = { $code }: ένα κλικ το παίρνει, το δεξί κουμπί το αφαιρεί
colour-nothing = Δεν υπάρχει πηλός κάτω από τον δείκτη

falloff-gaussian = Γκαουσιανή
falloff-smooth = Ομαλή
falloff-sphere = Σφαίρα
falloff-root = Ρίζα
falloff-sharp = Οξεία
falloff-linear = Γραμμική
falloff-constant = Σταθερή
falloff-custom = Δική σας

stamp-alpha = Άλφα
stamp-stamp = Σφραγίδα
stamp-size = Μέγεθος σφραγίδας
stamp-angle = Γωνία σφραγίδας
stamp-repeat = Επανάληψη της σφραγίδας
stamp-right = Στένσιλ δεξιά
stamp-up = Στένσιλ πάνω
stamp-at-tip = Από το μέσο της όψης, σε ύψη της
stamp-off = Καμία
stamp-dab = Κάτω από κάθε πινελιά
stamp-view = Κατά την όψη
stamp-stencil = Στένσιλ

alpha-studs = Καρφιά
alpha-scales = Λέπια
alpha-rope = Σχοινί
alpha-stitches = Ραφές
alpha-waves = Κύματα
alpha-bricks = Τούβλα
alpha-stone = Πέτρα
alpha-cracks = Ρωγμές
alpha-picture = Εικόνα αρχείου

automask-front = Μόνο μπροστινές όψεις
automask-topology = Μόνο συνδεδεμένα μέρη
automask-sets = Μόνο η ομάδα του πρώτου αγγίγματος
automask-boundary = Τα όρια μένουν
    .tip = Το όριο μιας ανοιχτής επιφάνειας δεν κινείται
automask-normal = Όριο καθέτου
    .tip = Μόνο ό,τι αποκλίνει από την κάθετο της πινελιάς το πολύ τόσες μοίρες· 0: όλα
automask-cavity = Κοιλότητα
    .tip = Πάνω από 0 μόνο κοιλότητες, κάτω από 0 μόνο ράχες

topology-by = Μήκος ακμών
topology-length = Μήκος
topology-split = Διαίρεση μακρύτερων ακμών
topology-collapse = Ένωση κοντύτερων ακμών
topology-off = Ανενεργό
topology-brush = Μέρος του πινέλου
topology-object = Μέρος του αντικειμένου
topology-view = Μέρος της όψης

## Mirror, pressure, masks, history

mirror-heading = Καθρέφτης

pressure-heading = Πίεση
pressure-curve = Καμπύλη πίεσης
    .tip = Σύρετε το αριστερό άκρο για το ελαφρύτερο άγγιγμα, το μέσο για την καμπή
pressure-lightest = Ελάχιστη
pressure-bend = Καμπή
pressure-radius = Ακτίνα
    .tip = Μέρος της ακτίνας στο ελαφρύτερο άγγιγμα
pressure-radius-curve = Καμπύλη πίεσης της ακτίνας
pressure-radius-bend = Κάμψη της ακτίνας

mask-heading = Μάσκα
mask-clear = Καθαρή
    .tip = Όλα είναι ελεύθερα
mask-fill = Πλήρης
    .tip = Όλα είναι προστατευμένα
mask-invert = Αντιστροφή
    .tip = Τα ελεύθερα προστατεύονται, τα προστατευμένα ελευθερώνονται
mask-blur = Θόλωμα
    .tip = Μαλακότερο όριο
mask-sharpen = Όξυνση
    .tip = Σκληρότερο όριο
mask-grow = Αύξηση
    .tip = Ένας δακτύλιος κορυφών ακόμη
mask-shrink = Μείωση
    .tip = Ένας δακτύλιος λιγότερος
mask-cavity = Κοιλότητες
    .tip = Οι κοιλότητες προστατεύονται
mask-thin = Λεπτά σημεία
    .tip = Ό,τι έχει το πολύ τόσο πάχος προστατεύεται
mask-occlusion = Σκιασμένα
    .tip = Ό,τι το αντικείμενο κρύβει από το φως προστατεύεται
mask-thin-below = λεπτό είναι
    .tip = Μερίδιο της μεγαλύτερης πλευράς
mask-note = { $keys } τη δείχνει· το πινέλο μάσκα τη βάφει

history-heading = Ιστορικό
history-steps = { $at } από { $all }
history-versions = { $count ->
    [one] { $count } έκδοση
   *[other] { $count } εκδόσεις
}
history-step = Βήμα
    .tip = Σύρετε για να περάσετε τα βήματα
history-after = Μετά το βήμα { $step }
history-version = Έκδοση
    .tip = Σύρετε για να περάσετε τις εκδόσεις αυτής της γραμμής
history-row = Έκδοση { $node }, στο { $time }
history-row-branch = Έκδοση { $node }, στο { $time }, σε κλάδο
history-replaced = αντικατάσταση
history-added = προσθήκη
history-removed = αφαίρεση
history-duplicated = αντίγραφο
history-renamed = μετονομασία
history-moved = μετακίνηση
history-activated = ενεργοποίηση
history-shown = προβολή
history-locked = κλείδωμα
history-reshaped = αναμόρφωση
history-layers = στρώσεις
history-sets = ομάδες όψεων
history-mask = μάσκα
history-remesh = μέγεθος τριγώνων
history-snapped = προσαρμόστηκε
history-arranged = άλλαξε θέση στη λίστα
history-set-named = ονομάστηκε σύνολο εδρών
history-followed = ακολούθησε τους τελεστέους
history-applied = εφαρμόστηκε η πράξη
history-mirrored = καθρεφτίστηκε
history-boolean = Boolean
history-merged = συγχώνευση
history-split = διαχωρισμός

## Page: look

look-material = Υλικό
material-clay = πηλός
material-porcelain = πορσελάνη
material-wax = κερί
material-stone = πέτρα
material-jade = νεφρίτης
material-bronze = μπρούντζος
material-graphite = γραφίτης
material-steel = ατσάλι
light-name = Φως
    .tip = Εικόνες περιβάλλοντος (HDR, EXR) και φωτισμένων σφαιρών, τετράγωνες, κρατιούνται όταν αφεθούν στο παράθυρο
light-studio = Στούντιο
light-room = Δωμάτιο
light-matcap = Φωτισμένη σφαίρα
light-turned = Στροφή
light-raised = Ύψος
light-shadow = Σκιές
    .tip = { $action }: ό,τι στέκεται στο κύριο φως σκοτεινιάζει ό,τι είναι πίσω του
light-bright = Φωτεινότητα
reference-name = Αναφορά
    .tip = Αφήστε στο παράθυρο μια εικόνα που δεν είναι τετράγωνη
reference-none = Καμία
reference-behind = Πίσω από τον πηλό
reference-opacity = Πυκνότητα
look-facets = Έδρες
look-cavity = Κοιλότητα
    .tip = Κοιλότητες σκουρότερες, ράχες φωτεινότερες
look-occlusion = Απόκρυψη
    .tip = { $action }: απόκρυψη περιβάλλοντος στον χώρο της οθόνης
look-wireframe = Πλέγμα ακμών
look-grid = Δάπεδο
look-smooth-edges = Ομαλά άκρα
    .tip = Τέσσερα δείγματα ανά εικονοστοιχείο· κοστίζει χρόνο χωρίς κάρτα γραφικών
look-map = Χάρτης
map-none = Κανένας
    .tip = Ο ίδιος ο πηλός
map-mask = Μάσκα
map-thickness = Πάχος
map-distance = Απόσταση
look-camera = Κάμερα
look-orthographic = Ορθογραφική
look-angle = Γωνία
    .tip = Οπτικό πεδίο, μοίρες
look-four-views = Τέσσερις όψεις
view-top = Από πάνω
view-free = Ελεύθερη
view-front = Από μπροστά
view-right = Από δεξιά
view-alone = Δείχνει μόνο αυτή την όψη, όπως ένα διπλό κλικ δίπλα στον πηλό. Με «{ $action }» πηγαίνετε και επιστρέφετε.
views-no-copies = Οι τέσσερις όψεις χρειάζονται οθόνη στην οποία αντιγράφονται εικόνες· αυτός ο οδηγός δεν το προσφέρει. Η εργασία συνεχίζεται σε μία όψη.
look-keep = Φύλαξη όψης
    .tip = Φυλάει αυτή την όψη με έναν αριθμό, για επιστροφή
    .show = Δείχνει ξανά αυτή την όψη· με δεξί κλικ διαγράφεται
legend-measuring = μετρά

## Page: scene

scene-object = Αντικείμενο
scene-size = { $x } x { $y } x { $z } { $unit }
scene-held = Κρατούμενο αντικείμενο
    .tip = Εμφανίζεται δίπλα στο αντικείμενο, για να μετακινηθεί μέσα του
scene-held-note = Πάρτε μια μορφή, μετακινήστε τη στη θέση της, ύστερα προσθήκη, κοπή ή κοινό.
scene-add = Προσθήκη
    .tip = Τα δύο γίνονται ένα
scene-cut = Κοπή
    .tip = Το κρατούμενο κόβεται από το αντικείμενο
scene-keep = Τομή
    .tip = Μένει μόνο ό,τι βρίσκεται και στα δύο
scene-put-down = Απόθεση
    .tip = Γίνεται αντικείμενο εκεί που είναι
scene-put-away = Απόσυρση
scene-busy = υπολογίζει στο παρασκήνιο: συνεχίστε
scene-preview = Προβολή
scene-computing = υπολογίζει ...
scene-shown = { $count } τρίγωνα του κρατούμενου αντικειμένου
scene-apply = Εφαρμογή
    .tip = Να γίνει ό,τι δείχνεται
scene-dismiss = Απόρριψη
    .tip = Το αντικείμενο μένει όπως είναι· και το κρατούμενο
scene-yaw = εκτροπή
scene-pitch = πρόνευση
scene-roll = κλίση
scene-scale = κλίμακα
scene-held-size = μέγεθος

objects-heading = Αντικείμενα
objects-add = Προσθήκη
objects-duplicate = Διπλασιασμός
objects-rename = Μετονομασία
objects-remove = Αφαίρεση
objects-locked = Κλειδωμένο: ούτε κινήσεις, ούτε μετακίνηση, ούτε αφαίρεση
objects-group = Ομάδα
    .tip = Ονομάζει την ομάδα του αντικειμένου· κενό όνομα την τερματίζει
objects-mirror = Καθρέφτης
objects-live = Ζωντανές πράξεις
    .tip = Οι τελεστέοι μένουν κρυφοί και το αποτέλεσμα υπολογίζεται ξανά όταν αλλάξει κάποιος
objects-follows = Ακολουθεί τους τελεστέους
objects-apply = Εφαρμογή
    .tip = Οι τελεστέοι φεύγουν και το αποτέλεσμα μένει ως έχει
objects-gizmo = Gizmo
    .tip = Μετακινεί, στρέφει και κλιμακώνει το αντικείμενο με τον δείκτη· με Ctrl σε βήματα
objects-snap = Έδρα με έδρα
    .tip = Ακουμπά μια επίπεδη έδρα ενός αντικειμένου σε έδρα άλλου
objects-snap-first = Πατήστε την έδρα που θα μετακινηθεί
objects-snap-second = Πατήστε την έδρα όπου θα ακουμπήσει
objects-eye = όψη
    .tip = Σχεδιάζεται
objects-lock = κλειδί
    .tip = Προστατευμένο από κινήσεις, μετακίνηση και αφαίρεση
objects-reset-place = Αρχική θέση
    .tip = Πίσω εκεί που φτιάχτηκε
shape-box = Κύβος
shape-ball = Σφαίρα
shape-cylinder = Κύλινδρος
shape-cone = Κώνος
shape-torus = Τόρος
shape-tube = Σωλήνας
shape-plane = Επίπεδο
operation-all = Και τα τέσσερα
    .tip = Ένωση, τομή και οι δύο διαφορές, καθένα αντικείμενο
operation-union = Ένωση
    .tip = Το ενεργό αντικείμενο και αυτό γίνονται ένα
operation-intersection = Τομή
    .tip = Μένει μόνο ό,τι βρίσκεται και στα δύο
operation-difference = Διαφορά
    .tip = Αυτό το αντικείμενο κόβεται από το ενεργό
operation-reverse-difference = Αντίστροφη διαφορά
    .tip = Το ενεργό κόβεται από αυτό

sets-heading = Ομάδες όψεων
sets-eye-tip = Εμφάνιση ή απόκρυψη της ομάδας
sets-colours = Εμφάνιση με χρώματα
sets-isolate = μόνο
    .tip = Κρύβει τα πάντα εκτός από αυτή την ομάδα
sets-draw = σχεδίαση
    .tip = Παίρνει το πινέλο που σχεδιάζει αυτή την ομάδα
sets-none = σε καμία ομάδα: { $count }
sets-row = ομάδα { $number }: { $count }
sets-hide-masked = Απόκρυψη μάσκας
    .tip = Κρύβει ό,τι έχει μάσκα τουλάχιστον κατά το μισό
sets-invert = Αντιστροφή ορατών
    .tip = Κρύβει τα ορατά και δείχνει τα κρυμμένα
sets-show-all = Εμφάνιση όλων
    .tip = Τίποτα δεν είναι πια κρυμμένο
sets-clear = Κατάργηση ομάδων
    .tip = Καμία κορυφή δεν είναι πια σε ομάδα· τα κρυμμένα μένουν κρυμμένα
sets-from-mask = Από μάσκα
    .tip = Ό,τι έχει μάσκα τουλάχιστον κατά το μισό γίνεται ομάδα
sets-from-visible = Από ορατά
    .tip = Ό,τι φαίνεται γίνεται ομάδα
sets-loose = Χωριστά μέρη
    .tip = Κάθε συνεχόμενο μέρος γίνεται ομάδα
sets-normals = Κατά διεύθυνση
    .tip = Κάθε μέρος που κοιτά περίπου προς μία πλευρά γίνεται ομάδα
sets-crease = Κατά ακμές
    .tip = Οι ομάδες συναντιούνται όπου η επιφάνεια κάμπτεται πάνω από τη γωνία
sets-degrees = Γωνία
sets-thickness = Πάχος
    .tip = Μέρος της μεγαλύτερης πλευράς· κάτω από 0 προς τα μέσα
sets-extract-mask = Εξαγωγή μάσκας
    .tip = Ό,τι έχει μάσκα γίνεται αντικείμενο: κλειστό κέλυφος αυτού του πάχους
sets-extract-name = απόσπασμα

layers-heading = Στρώσεις
layers-add = Νέα στρώση
    .tip = Οι κινήσεις πάνε στη νέα στρώση
layers-name = στρώση { $number }
layers-base = βάση
    .tip = Οι κινήσεις μένουν κάτω από όλες τις στρώσεις
layers-unseen = Η ενεργή στρώση είναι κρυφή ή έχει ένταση 0: οι κινήσεις δεν θα φαίνονταν
layers-topology = Η δυναμική τοπολογία ηρεμεί όσο το αντικείμενο έχει στρώσεις· ενσωματώστε τες για να τη χρησιμοποιήσετε
layers-eye = όψη
    .tip = Ορατή
layers-up = Πάνω
    .tip = Πάνω από την επόμενη στρώση
layers-down = Κάτω
    .tip = Κάτω από την επόμενη στρώση
layers-merge = Ένωση κάτω
    .tip = Την προσθέτει στην από κάτω στρώση, ή στη βάση. Πρέπει να φαίνονται και οι δύο
layers-duplicate = Διπλή στρώση
    .tip = Ένα κρυφό αντίγραφο από πάνω
layers-clear = Άδειασμα στρώσης
    .tip = Αφαιρεί ό,τι κάνει
layers-remove = Αφαίρεση στρώσης
    .tip = Την αφαιρεί μαζί με ό,τι κάνει
layers-rename = Όνομα στρώσης
layers-bake = Ενσωμάτωση
    .tip = Η επιφάνεια όπως είναι γίνεται βάση

levels-heading = Επίπεδα
levels-at = επίπεδο { $at } από { $all }, { $count } τρίγωνα
levels-coarser = Αδρότερο
    .tip = Πλάσιμο του συνόλου· η λεπτομέρεια των λεπτότερων ακολουθεί
levels-finer = Λεπτότερο
    .tip = Τέσσερα τρίγωνα για καθένα
    .back = Πίσω στο λεπτότερο επίπεδο

remesh-heading = Remesh
remesh-own = Δικό μου voxel
    .tip = Αλλιώς τα νέα τρίγωνα είναι περίπου όσο τα τωρινά
remesh-voxel = voxel
remesh-along = { $count } στη μακρύτερη πλευρά
remesh-sharp = Διατήρηση οξειών ακμών
remesh-button = Remesh
    .tip = Μία επιφάνεια από ίσα τρίγωνα· τα επικαλυπτόμενα μέρη γίνονται ένα. { $keys }
remesh-local-heading = Επί τόπου
remesh-local-edge = Μήκος ακμής
    .tip = Φορές το συνηθισμένο μήκος ακμής του αντικειμένου
remesh-local-undo = Με { $keys } αναιρείται ανά πάσα στιγμή, ακόμη και όσο εκτελείται.
remesh-stretched = Λεπτομέρεια όπου τεντώθηκε
    .tip = Χωρίζει τις πολύ μακριές ακμές όλου του αντικειμένου· ό,τι έχει μάσκα ή κρύβεται μένει

quads-heading = Τετράπλευρα
quads-count = τετράπλευρα
quads-levels = λεπτότερα επίπεδα
    .tip = Τα τετράπλευρα είναι το χαμηλότερο επίπεδο· τα λεπτότερα επαναφέρουν τη λεπτομέρεια
quads-button = Remesh με τετράπλευρα
    .tip = Τετράπλευρα που ακολουθούν το σχήμα· μια εξαγωγή χωρίς επίπεδα τα γράφει

decimate-heading = Αποδεκάτιση
decimate-share = των τριγώνων
decimate-button = Αποδεκάτιση
    .tip = Λιγότερα τρίγωνα, για εκτύπωση και ιστό. Δεν προκύπτουν νέες αυτοτομές και το όριο της μάσκας μένει

trim-heading = Περικοπή
trim-box = Πλαίσιο
    .tip = Σύρετε πλαίσιο στην όψη: ό,τι είναι μέσα του κόβεται πέρα ως πέρα
trim-line = Γραμμή
    .tip = Σύρετε γραμμή στην όψη: ό,τι είναι αριστερά της κόβεται
trim-note = Σύρετε στην όψη· Esc για ακύρωση.

region-heading = Περιοχή της όψης
region-draw = Περιοχή:
region-lasso = Λάσο
    .tip = Σύρετε γύρω από ό,τι εννοείτε
region-box = Πλαίσιο
    .tip = Σύρετε από γωνία σε γωνία
region-line = Γραμμή
    .tip = Σύρετε γραμμή: εννοείται ό,τι είναι αριστερά της
region-polyline = Πολύγωνο
    .tip = Πατήστε γωνία γωνία
region-front = Μόνο μπροστινές όψεις
    .tip = Μόνο ό,τι βλέπει προς εσάς· αλλιώς πέρα ως πέρα
region-mask = Μάσκα
    .tip = Προστατεύει ό,τι είναι στην περιοχή· με Ctrl: το ελευθερώνει
region-unmask = Χωρίς μάσκα
    .tip = Ελευθερώνει ό,τι είναι στην περιοχή· με Ctrl: το προστατεύει
region-hide = Απόκρυψη
    .tip = Κρύβει ό,τι είναι στην περιοχή· με Ctrl: όλα τα άλλα
region-isolate = Μόνο αυτή
    .tip = Κρύβει όλα τα άλλα· με Ctrl: ό,τι είναι στην περιοχή
region-face-set = Ομάδα
    .tip = Ό,τι είναι στην περιοχή γίνεται νέα ομάδα όψεων
region-remesh = Μέγεθος τριγώνων
    .tip = Τα τρίγωνα της περιοχής παίρνουν αυτό το μήκος ακμής, σε όλο το βάθος
region-done = Τέλος
    .tip = Τελειώνει τη σχεδίαση περιοχών (Esc)
region-note = Σύρετε στην όψη. Ctrl: αντίστροφα, Esc: τέλος.
region-polyline-note = Πατήστε κάθε γωνία· ξανά την πρώτη ή την τελευταία, ή Enter, κλείνει.

menu-add = προσθήκη
menu-carve = σκάψιμο
menu-keep = κοινό μέρος
menu-put-away = απόσυρση
menu-ball = σφαίρα
menu-box = κύβος
menu-cylinder = κύλινδρος
menu-undo = αναίρεση
menu-redo = επανάληψη
menu-pick-up = πιάσε

## Page: walls

walls-heading = Πάχος τοιχωμάτων
walls-live = Ζωντανός χάρτης
walls-process = Μέθοδος
walls-own-limit = δικό μου όριο
walls-too-thin-below = Λεπτό κάτω από
walls-note = Πατήστε { $keys }: ο χάρτης ακολουθεί τον πηλό όσο πλάθετε.
walls-thinnest = ελάχιστο
walls-median = διάμεσος
walls-thickest = μέγιστο
walls-too-thin = πολύ λεπτό
walls-measured = μετρημένο
walls-spots = Λεπτά σημεία
walls-none = Κανένα κάτω από το όριο.
walls-spot = { $number }: { $value } mm
    .tip = Η κάμερα πετά εκεί
walls-histogram = Ιστόγραμμα πάχους
    .tip = { $min } έως { $max } mm· η γραμμή είναι το όριο
process-abs = Χύτευση με έγχυση, ABS
process-fdm = Τηγμένο νήμα (FDM)
process-pa = Χύτευση με έγχυση, πολυαμίδιο (PA)
process-pc = Χύτευση με έγχυση, πολυκαρβονικό (PC)
process-pom = Χύτευση με έγχυση, ακετάλη (POM)
process-pp = Χύτευση με έγχυση, πολυπροπυλένιο (PP)
process-sla = Στερεολιθογραφία (SLA)
process-sls = Σύντηξη με λέιζερ (SLS)

## Page: size

measure-heading = Μετρήσεις
measure-waits = Μετριέται όταν τίποτα δεν αλλάζει.
measure-volume = όγκος
measure-area = εμβαδόν
measure-size = μήκος { $axis }
measure-shadow = σκιά { $axis }
measure-stale = Μιας προηγούμενης κατάστασης· ξαναμετριέται όταν τίποτα δεν αλλάζει.
shadow-heading = Σκιά
shadow-along = σκιά κατά { $axis }
    .tip = Θέαση κατά { $axis }
shadow-here = Από εδώ
    .tip = Θέαση όπως η κάμερα
shadow-size = { $x } x { $y } mm, { $holes } τρύπες
shadow-file = Σχέδιο προς εγγραφή
    .tip = Το αρχείο του σχεδίου
shadow-write = SVG
    .tip = Το περίγραμμα ως σχέδιο υπό κλίμακα, χιλιοστά
shadow-outline = Περίγραμμα της σκιάς
distance-heading = Απόσταση
distance-live = Χάρτης αποστάσεων
distance-before = από πριν
    .tip = Από το αντικείμενο όπως άνοιξε
distance-held = από το κρατούμενο
distance-now = Σύγκριση με το τώρα
    .tip = Οι αποστάσεις μετριούνται από το αντικείμενο όπως είναι τώρα
distance-note = Μπλε είναι μέσα, κόκκινο έξω.
distance-deepest = βαθύτερο
distance-highest = ψηλότερο
distance-rms = rms
distance-known = γνωστά

## Page: files

files-open = Άνοιγμα
    .note = Ρίξτε ένα πλέγμα στο παράθυρο, ή:
files-open-name = Αρχείο προς άνοιγμα
files-browse = Αναζήτηση...
files-recent = Πρόσφατα
files-earlier = Παλαιότερα γλυπτά
files-export = Εξαγωγή
files-export-name = Αρχείο προς εγγραφή
files-scale = Κλίμακα
files-unit = Μονάδα
unit-pixel = px
unit-mm = mm
unit-cm = cm
unit-m = m
unit-inch = ίντσες
files-save-as = Αποθήκευση ως...
files-pictures = Εικόνες
files-screenshot = Στιγμιότυπο
files-turntable = Περιστροφή
files-frames = καρέ
files-replace = Αντικατάσταση
    .question = Το { $path } υπάρχει. Να αντικατασταθεί;

chooser-open = Άνοιγμα πλέγματος
chooser-export = Εξαγωγή του γλυπτού
chooser-meshes = Πλέγματα
chooser-home = Αρχικός
chooser-documents = Έγγραφα
chooser-downloads = Λήψεις
chooser-desktop = Επιφάνεια εργασίας
chooser-up = Πάνω
chooser-reading = διαβάζει...
chooser-empty = ούτε φάκελοι ούτε αρχεία πλέγματος εδώ
chooser-name = Όνομα

start-heading = Συνέχεια με
start-note = Αυτό το νέο γλυπτό αποθηκεύεται καθώς δουλεύετε.
start-stay = Μείνετε εδώ
start-session = { $object }, { $date } { $time }

## Page: pens

devices-heading = Συσκευές
devices-none = Δεν βρέθηκε ταμπλέτα: συνδέστε μία, χωρίς επανεκκίνηση.
    .mouse = Πλάθει και το ποντίκι: οι αργές κινήσεις πιέζουν περισσότερο.
devices-camera = Κάμερα
    .privacy = Οι εικόνες μένουν σε αυτό το πρόγραμμα και δεν αποθηκεύονται.
devices-in-range = Τώρα εντός εμβέλειας
devices-pointer = δείκτης
devices-tablet = ταμπλέτα { $number }
devices-serial = σειριακή πένα { $number }
devices-recording = εγγραφή { $number }
devices-demo = πένα επίδειξης { $number }
devices-pen = πένα { $number }
devices-eraser = { $pen }, γόμα
devices-no-tilt = χωρίς κλίση
devices-tilt = κλίση { $x }, { $y } μοίρες
devices-pressure = πίεση { $pressure }, { $tilt }
devices-place = στο { $x } %, { $y } % της όψης
devices-hands = { $count ->
    [one] ένα χέρι
   *[other] { $count } χέρια
}
devices-strain = κόπωση χεριού { $percent } %
devices-rest = Το χέρι δουλεύει ψηλά: ξεκουράστε το ή δουλέψτε χαμηλότερα.
devices-nothing = τίποτα
devices-curve = Η καμπύλη πίεσης αριστερά δείχνει το τρέχον ίχνος της πένας.
pose-neutral = Ουδέτερη
pose-point = Δείκτης
pose-pinch = Τσίμπημα
pose-grab = Γροθιά
pose-flat = Επίπεδη
pose-open = Ανοιχτή

tablet-heading = Πλήκτρα της ταμπλέτας
tablet-choose = Επιλογή με πάτημα
    .tip = Ύστερα πατήστε το πλήκτρο της ταμπλέτας ή το κουμπί της πένας, ή γυρίστε τον δακτύλιο. Στο μεταξύ δεν κάνει τίποτε άλλο
tablet-listening = Πατήστε ένα πλήκτρο...
tablet-usual = Ως συνήθως ({ $action })
tablet-action = Ενέργεια: { $control }
tablet-line = { $control }: { $action }
tablet-reset = Επαναφορά
    .tip = Πάλι ως συνήθως
tablet-none = Όλα κάνουν ό,τι κάνουν συνήθως.
tablet-nothing = Τίποτα
tablet-next-mode = Επόμενη λειτουργία
tablet-radius = Ακτίνα
    .back = Ακτίνα, ανάποδα
tablet-strength = Δύναμη
    .back = Δύναμη, ανάποδα
tablet-turn = Στροφή της όψης όσο πατιέται
tablet-slide = Μετακίνηση της όψης όσο πατιέται
tablet-zoom = Ζουμ όσο πατιέται
tablet-radius-and-strength = Ακτίνα και δύναμη με σύρσιμο
tablet-carve = Σκάψιμο όσο πατιέται
tablet-brush = Πινέλο { $brush }
    .held = Πινέλο { $brush } όσο πατιέται
control-key = Πλήκτρο { $number }
control-barrel = Κουμπί πένας { $number }
control-eraser = Γόμα
control-wheel = Ροδέλα { $number }
control-ring = Δακτύλιος { $number }
control-strip = Λωρίδα { $number }

## Page: loop

loop-heading = Βρόχος
loop-tick = χτύπος
loop-late = αργοπορίες
loop-samples = δείγματα
loop-dabs = πινελιές
loop-lost = χαμένα
    .note = χαμένα: κίνηση + επαφές
loop-window = Αυτό το παράθυρο
loop-frames = καρέ/s
loop-frame = καρέ
loop-worst = χειρότερο
loop-to-clay = ως πηλό
loop-to-screen = ως οθόνη
    .note = ως πηλό, ως οθόνη: από το νεότερο δείγμα
loop-in-view = σε όψη
loop-of = { $part } από { $all }
loop-uploaded = στάλθηκαν
loop-object = Αντικείμενο
loop-vertices = κορυφές
loop-triangles = τρίγωνα
loop-saved = αποθηκεύεται καθώς δουλεύετε: { $path }
loop-sample-to-screen = Από το δείγμα στην οθόνη
loop-up-to = έως { $value } ms
loop-longer = περισσότερο
loop-class = { $class }: { $count }
loop-histogram = { $frames } καρέ· { $first } ms, και διπλάσιο σε κάθε ράβδο
stage-tick = χτύπος
    .about = από την ανάγνωση ως το τέλος του χτύπου που το πήρε
stage-wait = αναμονή
    .about = από το τέλος εκείνου του χτύπου ως την αρχή ενός καρέ
stage-draw = σχεδίαση
    .about = από την αρχή του καρέ ως την παράδοση της εικόνας
stage-present = προβολή
    .about = από την παράδοση ως την προβολή
stage-total = σύνολο
    .about = από την ανάγνωση ως την προβολή

## Page: more

preferences-heading = Προτιμήσεις
preferences-language = Γλώσσα
preferences-language-system = Του συστήματος ({ $name })
preferences-font = Η γλώσσα { $name } χρειάζεται γραμματοσειρά που λείπει. Εγκαταστήστε μία με τα γράμματά της, όπως η Noto Sans CJK, και διαλέξτε ξανά τη γλώσσα.
preferences-text-size = Κείμενο
preferences-light = Φωτεινά πλαίσια
preferences-speed = Η ταχύτητα είναι πίεση
    .tip = Για ποντίκι: οι αργές κινήσεις πιέζουν περισσότερο από τις γρήγορες
preferences-lead = Εμφάνιση της πινελιάς πριν από τη γραφίδα
    .tip = Ό,τι θα υψώσει η γραφίδα ώσπου να φανεί η εικόνα· ο ίδιος ο πηλός εξαρτάται μόνο από τη γραφίδα
preferences-fingers = Δύο δάχτυλα
    .tip = Σε οθόνη αφής. Με τσίμπημα κάνουν ζουμ· τρία δάχτυλα κάνουν το άλλο, χτύπημα με τρία αναιρεί, με τέσσερα επαναλαμβάνει
preferences-fingers-turn = Στροφή
preferences-fingers-slide = Μετακίνηση
preferences-lesson-skip = Παράλειψη μαθήματος
preferences-lesson-again = Ξανά το πρώτο μάθημα
preferences-keys = Πλήκτρα...
preferences-help = Βοήθεια
preferences-search = Αναζήτηση ενεργειών
preferences-no-session = Χωρίς αρχείο συνεδρίας: το γλυπτό μένει μόνο αν το εξαγάγετε.

messages-heading = Μηνύματα
messages-loading = Φόρτωση { $name }

## The window of the keys

keys-heading = Πλήκτρα
keys-set = Σύνολο
keys-as-in-set = Όπως στο σύνολο
    .tip = Ξεχνά κάθε πλήκτρο που αλλάξατε
keys-find = Εύρεση
keys-note = Κάντε κλικ στα πλήκτρα μιας ενέργειας για να τα αλλάξετε.
keys-shared = { $count ->
    [one] { $count } ενέργεια έχει ίδια πλήκτρα με άλλη
   *[other] { $count } ενέργειες έχουν ίδια πλήκτρα με άλλη
}
keys-press = Πατήστε...
keys-of = Πλήκτρα για { $action }
    .tip = Κλικ, ύστερα τα νέα πλήκτρα. Esc τα αφήνει, Delete τα αφαιρεί
keys-also = επίσης: { $actions } (προηγείται η επιλεγμένη)
    .own = επίσης: { $actions } (εκτελείται αυτή)
keys-unknown-action = keys.own: καμία ενέργεια δεν λέγεται "{ $id }"
keys-unreadable = keys.own.{ $id }: το "{ $keys }" δεν είναι πλήκτρο: αναμένεται π.χ. Z, F12, [ ή Ctrl+Shift+Z

## Search, radial menu, dragged settings, curves

search-heading = Αναζήτηση ενεργειών
search-nothing = τίποτα δεν λέγεται έτσι

radial-radius = Ακτίνα
radial-mirror = Καθρέφτης x
radial-thickness = Πάχος
radial-frame = Κάδρο
radial-strength = Δύναμη
radial-carve = Σκάψιμο

modal-radius = Ακτίνα { $value }: κλικ για να μείνει, Esc για την προηγούμενη
modal-strength = Δύναμη { $value }: κλικ για να μείνει, Esc για την προηγούμενη

curve-note = Σχεδιάστε ή βάλτε σημεία: αλλάζουν πριν ακολουθήσει το πινέλο.
curve-points = { $count ->
    [one] { $count } σημείο
   *[other] { $count } σημεία
}
curve-draw = Χάραξη καμπύλης
    .tip = Το πινέλο την ακολουθεί, ως ένα βήμα (Enter)
curve-remove = Αφαίρεση σημείου
    .tip = Delete, ή δεξί κλικ πάνω του
curve-discard = Απόρριψη
    .tip = Δεν χαράζεται τίποτα (Esc)

## The first lesson

lesson-demo = Τρέχει η επίδειξη. Αγγίξτε τον πηλό όποτε θέλετε
lesson-line = { $hint } ({ $at } από { $all })
lesson-sculpt = Πατήστε και σύρετε πάνω στον πηλό
lesson-turn = Σύρετε δίπλα στον πηλό για να τον στρέψετε, με τη ροδέλα ζουμ
lesson-smooth = Κρατήστε Shift και περάστε πάνω από ό,τι φτιάξατε: λειαίνεται
lesson-carve = Κρατήστε Ctrl και σύρετε: σκάβει αντί να υψώνει
lesson-undo = { $keys } αναιρεί την τελευταία κίνηση
lesson-mirror = { $keys }, ή x στον Καθρέφτη αριστερά, και μια κίνηση: και οι δύο πλευρές
    .no-keys = Διαλέξτε x στον Καθρέφτη αριστερά και κάντε μια κίνηση: και οι δύο πλευρές

## Help

help-heading = Βοήθεια
help-pages = Σελίδες δεξιά
help-keys = Πλήκτρα
help-pen = Πένα ή ποντίκι
help-pen-press = Πάτημα και σύρσιμο στον πηλό
    .does = Πλάσιμο
help-pen-carve = Το ίδιο με Ctrl ή Alt
    .does = Σκάψιμο αντί για ύψωση, για μία κίνηση
help-pen-smooth = Το ίδιο με Shift
    .does = Λείανση, για μία κίνηση
help-pen-turn = Σύρσιμο δίπλα στον πηλό, ή με το δεξί κουμπί
    .does = Στροφή της όψης
help-pen-slide = Μεσαίο κουμπί, ή δεξί με Shift
    .does = Μετακίνηση της όψης
help-pen-zoom = Ροδέλα
    .does = Πλησίασμα σε ό,τι είναι κάτω από τον δείκτη
help-pen-menu = Κρατημένο διάστημα
    .does = Μενού γύρω από τον δείκτη
help-fingers = Δάχτυλα σε οθόνη
help-fingers-one = Ένα δάχτυλο στον πηλό
    .does = Πλάσιμο
help-fingers-two = Δύο δάχτυλα
    .does = Στροφή της όψης· με τσίμπημα ζουμ
help-fingers-three = Τρία δάχτυλα
    .does = Μετακίνηση της όψης (η σελίδα Άλλα τα ανταλλάσσει)
help-fingers-tap = Χτύπημα με τρία, με τέσσερα
    .does = Αναίρεση, επανάληψη
help-hands = Γυμνά χέρια πάνω από αισθητήρα
help-hands-index = Τεντωμένος δείκτης
    .does = Το ακροδάχτυλο σπρώχνει τον πηλό
help-hands-pinch = Αντίχειρας και δείκτης κλειστοί
    .does = Πιάσιμο, μεταφορά, άφημα πηλού
help-hands-flat = Δάχτυλα τεντωμένα και ενωμένα
    .does = Η παλάμη πιέζει και λειαίνει
help-hands-open = Δάχτυλα τεντωμένα και ανοιχτά
    .does = Στροφή της όψης· με δύο χέρια ζουμ
help-hands-fist = Γροθιά
    .does = Μετακίνηση της όψης
help-hands-both = Τσίμπημα με τα δύο χέρια
    .does = Κράτημα του γλυπτού: στροφή, μετακίνηση, κλίμακα
help-hands-menu = Ένα δάχτυλο μένει σε σφαίρα αριστερά
    .does = Επιλογή από το μενού των χεριών
help-work = Η δουλειά φυλάγεται
help-work-close = Κλείσιμο του παραθύρου όποτε θέλετε
    .does = Η συνεδρία συνεχίζει από εκεί που ήταν
help-work-files = Σελίδα Αρχεία
    .does = Άνοιγμα, εξαγωγή, παλαιότερα γλυπτά

## Actions

action-brush = Πινέλο { $brush }
action-page = Σελίδα: { $page }
action-undo = Αναίρεση
action-redo = Επανάληψη
action-carve = Σκάψιμο ή ύψωση
action-larger = Μεγαλύτερο πινέλο
action-smaller = Μικρότερο πινέλο
action-stronger = Δυνατότερο πινέλο
action-weaker = Ασθενέστερο πινέλο
action-drag-radius = Σύρσιμο της ακτίνας
action-drag-strength = Σύρσιμο της δύναμης
action-sample-colour = Λήψη του χρώματος
action-mirror-x = Καθρέφτης ως προς x
action-mirror-y = Καθρέφτης ως προς y
action-mirror-z = Καθρέφτης ως προς z
action-frame = Γλυπτό στο κάδρο
action-front = Όψη από μπροστά
action-back = Όψη από πίσω
action-left = Όψη από αριστερά
action-right = Όψη από δεξιά
action-top = Όψη από πάνω
action-bottom = Όψη από κάτω
action-perspective = Προοπτική ή ορθογραφική
action-four-views = Τέσσερις όψεις ή μία
action-next-material = Επόμενο υλικό
action-facets = Ομαλή ή επίπεδη σκίαση
action-ssao = Απόκρυψη περιβάλλοντος
action-shadows = Σκιές
action-wireframe = Πλέγμα ακμών
action-grid = Δάπεδο
action-thickness = Χάρτης πάχους
action-mask = Χάρτης μάσκας
action-distance = Χάρτης αποστάσεων
action-trim-box = Περικοπή με πλαίσιο
action-trim-line = Περικοπή με γραμμή
action-region-lasso = Περιοχή με λάσο
action-region-box = Περιοχή με πλαίσιο
action-region-line = Περιοχή με γραμμή
action-region-polyline = Περιοχή με πολύγωνο
action-region-mask = Μάσκα σε περιοχή
action-region-unmask = Χωρίς μάσκα σε περιοχή
action-region-hide = Απόκρυψη περιοχής
action-region-isolate = Μόνο μία περιοχή
action-region-face-set = Ομάδα όψεων από περιοχή
action-finer = Λεπτότερο επίπεδο
action-coarser = Αδρότερο επίπεδο
action-remesh = Remesh
action-try-add = Προεπισκόπηση: προσθήκη του κρατούμενου
action-try-cut = Προεπισκόπηση: κοπή με το κρατούμενο
action-try-keep = Προεπισκόπηση: το κοινό μέρος
action-open-mesh = Άνοιγμα πλέγματος
action-export = Εξαγωγή του πλέγματος
action-screenshot = Στιγμιότυπο
action-turntable = Καρέ περιστροφής
action-search = Αναζήτηση ενεργειών
action-panels = Πλαίσια
action-light-or-dark = Φωτεινό ή σκούρο
action-larger-text = Μεγαλύτερο κείμενο
action-smaller-text = Μικρότερο κείμενο
action-help = Βοήθεια
action-keys = Αλλαγή των πλήκτρων
action-lesson = Πρώτο μάθημα

## Messages of background tasks

task-loaded = { $name }: { $count } κορυφές
task-exported = Αποθηκεύτηκε: { $path }: { $x } x { $y } x { $z } { $unit }
task-saved = Αποθηκεύτηκε: { $path }
task-frames = Αποθηκεύτηκαν { $frames } καρέ στο { $folder }
task-failed = { $path }: { $error }
task-done = { $operation }: έγινε
task-snapped = Οι έδρες εφάπτονται
task-mirrored = Προστέθηκε κατοπτρικό δίδυμο
task-trimmed = Περικόπηκε
task-level = Επίπεδο { $at } από { $all }
task-remesh-local = Ακμές που άλλαξαν: { $count }
task-remesh-taken-back = Το νέο πλέγμα αναιρέθηκε πριν ολοκληρωθεί.
task-remeshed = Remesh: { $count } τρίγωνα, voxel { $voxel }, όγκος { $change } %· τομές: { $crossings }
task-remesh-lost = Χάθηκαν μέρη λεπτότερα από ένα voxel, για παράδειγμα στο { $x }, { $y }, { $z }: αναιρέστε και χρησιμοποιήστε μικρότερο voxel
task-quads = { $quads } τετράπλευρα και { $triangles } τρίγωνα· τομές: { $crossings }
task-decimated = { $before } τρίγωνα έγιναν { $now }· νέες τομές: { $crossings }
task-layers-baked = Στρώσεις που ενσωματώθηκαν στη νέα επιφάνεια: { $count }
task-sets-made = Δημιουργήθηκαν ομάδες όψεων
task-mask-measured = Με μάσκα: { $count } κορυφές
task-sets-dropped = Οι ομάδες όψεων χάθηκαν με την παλιά επιφάνεια· τίποτα δεν είναι πια κρυμμένο
task-extracted = Εξήχθη αντικείμενο με { $count } κορυφές
task-preferences-unreadable = { $path }: { $error }· φυλάχτηκε ως { $aside }
task-preferences-stuck = { $path }: { $error }· δεν μπορεί να παραμεριστεί: { $why }
task-brush-saved = Το πινέλο { $name } αποθηκεύτηκε
task-brush-not-saved = Το πινέλο δεν αποθηκεύτηκε: { $error }
task-picture-kept = Κρατήθηκε ως { $path }
task-preferences-unread = { $path }: οι προτιμήσεις δεν διαβάζονται: { $error }
task-preferences-not-kept = { $path }: οι προτιμήσεις δεν αποθηκεύτηκαν: { $error }
language-unreadable = { $path }: { $error }

## People who share the sculpture

people-heading = Άτομα
people-you = { $name } (εσείς)
people-gone = Έφυγαν: { $names }
people-sculptor = γλύπτης
people-viewer = θεατής
people-device = συσκευή
people-invite = Πρόσκληση με κωδικό
people-invite-about = Σαρώστε τον με τηλέφωνο ή ταμπλέτα αυτού του δικτύου ή ανοίξτε τον σύνδεσμο: πλάθετε στον περιηγητή.
people-invite-copy = Αντιγραφή συνδέσμου
undo-in-the-way = Δεν αναιρέθηκε: { $name } άλλαξε έκτοτε το ίδιο σημείο. Όταν { $name } το αναιρέσει, θα γίνεται.
redo-in-the-way = Δεν επαναλήφθηκε: { $name } άλλαξε έκτοτε το ίδιο σημείο. Όταν { $name } το αναιρέσει, θα γίνεται.
