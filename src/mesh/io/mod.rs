//! Mesh files: OBJ, STL, PLY, glTF/GLB, 3MF, OFF, in and out.
