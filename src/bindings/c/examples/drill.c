/* Reads a part, takes a drill from it, measures the walls, writes the result.
 *
 *     drill PART.stl DRILL.stl OUT.3mf
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "sculptd.h"

static int failed(const char *what) {
    fprintf(stderr, "%s: %s\n", what, sculptd_error_message());
    return EXIT_FAILURE;
}

/* A box from the origin, in case no files were given. */
static SculptdStatus box(double x, double y, double z, double at, SculptdMesh **mesh) {
    double v[24];
    for (int i = 0; i < 8; i++) {
        v[3 * i] = at + ((i & 1) != 0 ? x : 0.0);
        v[3 * i + 1] = at + ((i & 2) != 0 ? y : 0.0);
        v[3 * i + 2] = at + ((i & 4) != 0 ? z : 0.0);
    }
    const uint32_t faces[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4,
                                2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    const uint32_t starts[7] = {0, 4, 8, 12, 16, 20, 24};
    return sculptd_mesh_new(v, 8, faces, starts, 6, mesh);
}

int main(int count, char **arguments) {
    SculptdMesh *part = NULL, *drill = NULL, *made = NULL;
    const int files = count == 4;
    printf("sculptd %s\n", sculptd_version());
    if ((files ? sculptd_mesh_read(arguments[1], &part) : box(4, 4, 4, 0, &part)) !=
        SCULPTD_STATUS_OK) {
        return failed("the part");
    }
    if ((files ? sculptd_mesh_read(arguments[2], &drill) : box(2, 2, 9, 1, &drill)) !=
        SCULPTD_STATUS_OK) {
        sculptd_mesh_free(part);
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
    status = files ? sculptd_mesh_write(made, arguments[3]) : SCULPTD_STATUS_OK;
    sculptd_mesh_free(made);
    if (status != SCULPTD_STATUS_OK) {
        return failed("the result");
    }
    /* What is wrong is told, never followed. */
    if (sculptd_mesh_read("/nowhere.stl", &made) != SCULPTD_STATUS_IO) {
        return EXIT_FAILURE;
    }
    printf("as expected: %s\n", sculptd_error_message());
    return sculptd_boolean(NULL, NULL, 0, -1.0, &made, NULL) == SCULPTD_STATUS_ARGUMENT
               ? EXIT_SUCCESS
               : EXIT_FAILURE;
}
