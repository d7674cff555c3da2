/* Reads a part, takes a drill from it, measures and judges the walls, cuts sections, writes the
 * result, and lists what the files do not hold.
 *
 *     drill PART.stl DRILL.stl OUT.3mf
 *
 * Without arguments the part and the drill are boxes, and every figure is compared with the one
 * that is known.
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sculptd.h"

static int failed(const char *what) {
    fprintf(stderr, "%s: %s\n", what, sculptd_error_message());
    return EXIT_FAILURE;
}

/* A box from the origin, in case no files were given. `faces`: how many of its six faces it has. */
static SculptdStatus box(double x, double y, double z, double at, size_t faces,
                         SculptdMesh **mesh) {
    double v[24];
    for (int i = 0; i < 8; i++) {
        v[3 * i] = at + ((i & 1) != 0 ? x : 0.0);
        v[3 * i + 1] = at + ((i & 2) != 0 ? y : 0.0);
        v[3 * i + 2] = at + ((i & 4) != 0 ? z : 0.0);
    }
    const uint32_t corners[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4,
                                  2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    const uint32_t starts[7] = {0, 4, 8, 12, 16, 20, 24};
    return sculptd_mesh_new(v, 8, corners, starts, faces, mesh);
}

/* Prints a list of sentences and frees it. */
static void print_all(const char *what, SculptdSentences *sentences) {
    const char *text = NULL;
    for (size_t i = 0; (text = sculptd_sentences_get(sentences, i)) != NULL; i++) {
        printf("%s: %s\n", what, text);
    }
    sculptd_sentences_free(sentences);
}

/* What was read, what it holds, and what stayed in the file. */
static SculptdStatus print_contents(const char *name, const SculptdMesh *mesh) {
    SculptdMeshContents has;
    SculptdSentences *unread = NULL;
    SculptdStatus status = sculptd_mesh_contents(mesh, &has);
    if (status == SCULPTD_STATUS_OK) {
        status = sculptd_mesh_unread(mesh, &unread);
    }
    if (status != SCULPTD_STATUS_OK) {
        return status;
    }
    const char *format = sculptd_mesh_format(mesh);
    printf("%s: %s, %zu vertices, %zu faces, %zu groups%s%s%s\n", name,
           format != NULL ? format : "from no file", has.vertices, has.faces, has.groups,
           has.colours ? ", colours" : "", has.materials ? ", materials" : "",
           has.texture_coordinates ? ", texture coordinates" : "");
    print_all("  not read", unread);
    return status;
}

static int near(double value, double expected) { return fabs(value - expected) < 1e-9; }

/* The section of a mesh at a height along z; its contours are printed. */
static SculptdStatus print_section(const SculptdMesh *mesh, double height,
                                   SculptdSectionFacts *facts) {
    const double up[3] = {0, 0, 1};
    SculptdSections *sections = NULL;
    SculptdStatus status = sculptd_sections(mesh, up, &height, 1, &sections);
    if (status == SCULPTD_STATUS_OK) {
        status = sculptd_section_facts(sections, 0, facts);
    }
    if (status == SCULPTD_STATUS_OK) {
        printf("section at %g: area %.3f, perimeter %.3f, %zu contours\n", height, facts->area,
               facts->perimeter, facts->contours);
    }
    double sum = 0.0;
    for (size_t i = 0; status == SCULPTD_STATUS_OK && i < facts->contours; i++) {
        SculptdContour contour;
        status = sculptd_section_contour(sections, 0, i, &contour);
        if (status == SCULPTD_STATUS_OK) {
            sum += contour.area;
            printf("  %s of %zu points, area %.3f, from %g %g %g\n",
                   !contour.closed ? "open line"
                   : contour.area < 0 ? "hole"
                                      : "outline",
                   contour.count, contour.area, contour.points[0], contour.points[1],
                   contour.points[2]);
        }
    }
    SculptdContour beyond;
    if (status == SCULPTD_STATUS_OK &&
        (!near(sum, facts->area) || sculptd_sections_count(sections) != 1 ||
         sculptd_section_contour(sections, 0, facts->contours, &beyond) !=
             SCULPTD_STATUS_ARGUMENT)) {
        status = SCULPTD_STATUS_DEFECT;
    }
    sculptd_sections_free(sections);
    return status;
}

/* The verdict of a preset and of own limits on the walls. */
static SculptdStatus print_verdict(const SculptdMesh *mesh, const char *preset,
                                   const SculptdLimits *limits, SculptdJudgementFacts *facts) {
    static const char *const names[] = {"unjudged", "pass", "warn", "fail", "undecided"};
    SculptdJudgement *judgement = NULL;
    SculptdSentences *warnings = NULL;
    SculptdStatus status = sculptd_judge(mesh, preset, limits, &judgement);
    if (status == SCULPTD_STATUS_OK) {
        status = sculptd_judgement_facts(judgement, facts);
    }
    if (status == SCULPTD_STATUS_OK) {
        status = sculptd_judgement_warnings(judgement, &warnings);
    }
    if (status == SCULPTD_STATUS_OK) {
        size_t count = 0;
        const SculptdThinPlace *worst = sculptd_judgement_worst(judgement, &count);
        printf("walls: %s: %s\n", names[facts->verdict], sculptd_judgement_statement(judgement));
        for (size_t i = 0; i < count && i < 3; i++) {
            printf("  %.3f mm at %.3f %.3f %.3f, %.3f mm2\n", (double)worst[i].thickness,
                   worst[i].position[0], worst[i].position[1], worst[i].position[2],
                   worst[i].area);
        }
        print_all("  warning", warnings);
    }
    sculptd_judgement_free(judgement);
    return status;
}

/* Compares the figures of the boxes with the known ones, and passes wrong arguments. */
static int known(const SculptdMesh *made) {
    SculptdSectionFacts cut;
    /* Through the hole, through the floor below it, in the face at the bottom, and above all. */
    const double expected[4][4] = {{2, 12, 24, 2}, {0.5, 16, 16, 1}, {0, 16, 16, 1}, {9, 0, 0, 0}};
    for (int i = 0; i < 4; i++) {
        if (print_section(made, expected[i][0], &cut) != SCULPTD_STATUS_OK ||
            !near(cut.area, expected[i][1]) || !near(cut.perimeter, expected[i][2]) ||
            !near((double)cut.contours, expected[i][3]) || cut.open != 0 || cut.folded != 0.0) {
            return failed("a section");
        }
    }
    if (!isnan(cut.centroid[0])) {
        return failed("the centroid of nothing");
    }
    /* A box without its last face gives one contour with two ends. */
    SculptdMesh *open = NULL;
    if (box(4, 4, 4, 0, 5, &open) != SCULPTD_STATUS_OK ||
        print_section(open, 2, &cut) != SCULPTD_STATUS_OK || cut.open != 1 ||
        !near(cut.perimeter, 12)) {
        sculptd_mesh_free(open);
        return failed("an open section");
    }
    sculptd_mesh_free(open);
    const struct {
        const char *preset;
        SculptdLimits limits;
        SculptdVerdict verdict;
    } cases[] = {
        {NULL, {0}, SCULPTD_VERDICT_UNJUDGED},
        {NULL, {.fail_below = 1.2F}, SCULPTD_VERDICT_FAIL},
        {NULL, {.fail_below = 0.5F}, SCULPTD_VERDICT_PASS},
        {NULL, {.fail_below = 0.5F, .warn_below = 1.2F}, SCULPTD_VERDICT_WARN},
        {NULL, {.fail_above = 0.5F}, SCULPTD_VERDICT_FAIL},
        {"fdm", {.fail_below = 1.5F, .warn_below = 1.6F}, SCULPTD_VERDICT_FAIL},
    };
    SculptdJudgementFacts walls;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        if (print_verdict(made, cases[i].preset, &cases[i].limits, &walls) != SCULPTD_STATUS_OK ||
            walls.verdict != cases[i].verdict) {
            return failed("a verdict");
        }
        /* The floor and the four walls are 1 mm thick. */
        if (fabs(walls.least_lower - 1) > 1e-4 || fabs(walls.least_upper - 1) > 1e-4 ||
            !walls.certified || walls.united || walls.limits.fail_below != cases[i].limits.fail_below) {
            return failed("the least wall");
        }
    }
    const double nothing[3] = {0, 0, 0}, up[3] = {0, 0, 1}, nowhere = NAN;
    const SculptdLimits wrong = {.fail_below = -1.0F};
    SculptdSections *sections = NULL;
    SculptdJudgement *judgement = NULL;
    SculptdSentences *sentences = NULL;
    if (sculptd_sections(made, nothing, up, 1, &sections) != SCULPTD_STATUS_ARGUMENT ||
        sculptd_sections(made, up, &nowhere, 1, &sections) != SCULPTD_STATUS_ARGUMENT ||
        sculptd_sections(made, up, NULL, 1, &sections) != SCULPTD_STATUS_ARGUMENT ||
        sculptd_sections(NULL, up, up, 1, &sections) != SCULPTD_STATUS_ARGUMENT ||
        sculptd_section_facts(NULL, 0, &cut) != SCULPTD_STATUS_ARGUMENT ||
        sculptd_judge(made, NULL, &wrong, &judgement) != SCULPTD_STATUS_ARGUMENT ||
        sculptd_mesh_unwritten(made, "x.jpg", &sentences) != SCULPTD_STATUS_ARGUMENT ||
        sculptd_judge(made, "glass", NULL, &judgement) != SCULPTD_STATUS_ARGUMENT ||
        strstr(sculptd_error_message(), "there are fdm") == NULL) {
        return failed("a wrong argument was taken");
    }
    printf("as expected: %s\n", sculptd_error_message());
    return EXIT_SUCCESS;
}

int main(int count, char **arguments) {
    SculptdMesh *part = NULL, *drill = NULL, *made = NULL;
    const int files = count == 4;
    printf("sculptd %s\n", sculptd_version());
    if ((files ? sculptd_mesh_read(arguments[1], &part) : box(4, 4, 4, 0, 6, &part)) !=
            SCULPTD_STATUS_OK ||
        print_contents("part", part) != SCULPTD_STATUS_OK) {
        sculptd_mesh_free(part);
        return failed("the part");
    }
    if ((files ? sculptd_mesh_read(arguments[2], &drill) : box(2, 2, 9, 1, 6, &drill)) !=
            SCULPTD_STATUS_OK ||
        print_contents("drill", drill) != SCULPTD_STATUS_OK) {
        sculptd_mesh_free(part);
        sculptd_mesh_free(drill);
        return failed("the drill");
    }
    SculptdBooleanFacts facts;
    SculptdStatus status =
        sculptd_boolean(part, drill, SCULPTD_OPERATION_DIFFERENCE, -1.0, &made, &facts);
    sculptd_mesh_free(part);
    sculptd_mesh_free(drill);
    if (status != SCULPTD_STATUS_OK) {
        return failed("the difference");
    }
    size_t vertices = 0, faces = 0;
    const double *at = sculptd_mesh_vertices(made, &vertices);
    (void)sculptd_mesh_face_starts(made, &faces);
    printf("volume %.3f, %zu vertices, %zu faces, manifold: %s\n", facts.volume, vertices, faces,
           facts.manifold ? "yes" : "no");
    if (vertices > 0) {
        printf("the first vertex: %g %g %g\n", at[0], at[1], at[2]);
    }
    float *walls = malloc(vertices * sizeof *walls);
    SculptdThickness thickness;
    if (walls == NULL ||
        sculptd_thickness(made, 0, walls, vertices, &thickness) != SCULPTD_STATUS_OK) {
        free(walls);
        sculptd_mesh_free(made);
        return failed("the thickness");
    }
    printf("walls from %.3f to %.3f, median %.3f\n", (double)thickness.min, (double)thickness.max,
           (double)thickness.median);
    free(walls);
    if (files) {
        SculptdSentences *unwritten = NULL;
        SculptdJudgementFacts verdict;
        status = print_verdict(made, "fdm", NULL, &verdict);
        if (status == SCULPTD_STATUS_OK) {
            status = sculptd_mesh_unwritten(made, arguments[3], &unwritten);
        }
        if (status == SCULPTD_STATUS_OK) {
            print_all("not written", unwritten);
            status = sculptd_mesh_write(made, arguments[3]);
        }
    } else if (known(made) != EXIT_SUCCESS) {
        sculptd_mesh_free(made);
        return EXIT_FAILURE;
    }
    sculptd_mesh_free(made);
    if (status != SCULPTD_STATUS_OK) {
        return failed("the result");
    }
    /* A failure has a number and a sentence; null is an error. */
    if (sculptd_mesh_read("/nowhere.stl", &made) != SCULPTD_STATUS_IO) {
        return EXIT_FAILURE;
    }
    printf("as expected: %s\n", sculptd_error_message());
    return sculptd_boolean(NULL, NULL, 0, -1.0, &made, NULL) == SCULPTD_STATUS_ARGUMENT
               ? EXIT_SUCCESS
               : EXIT_FAILURE;
}
