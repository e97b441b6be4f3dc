// SPDX-License-Identifier: MIT
#ifndef EEVEE_BODIES_SHARED_H
#define EEVEE_BODIES_SHARED_H

/**
 * Texels of `bodies`, a texture of texels in a row: the head, the nodes of a tree of boxes in depth-first order, the triangles in the order
 * of its leaves. World space.
 *
 * Head: rgb radiance or factor of the background and its alpha; the number of nodes, the rotation of the background's picture in turns,
 * whether there is such a picture.
 * Node: least corner of its box, and the node that follows its descendants; greatest corner, and first triangle * BODY_LEAF + number of
 * triangles (0: no leaf).
 * Triangle: a corner, and the material; two edges; the normals at its corners. Its front is outside.
 */
#define BODY_HEAD_TEXELS 2
#define BODY_NODE_TEXELS 2
#define BODY_TRIANGLE_TEXELS 6
/** The number in a leaf is its first triangle times BODY_LEAF, plus the count of its triangles. */
#define BODY_LEAF 8
/** Most nodes, and most triangles: floats hold the numbers. */
#define BODY_TRIANGLE_MAX 2097152

/** Most surfaces on the way of the light behind the nearest one. */
#define BODY_SURFACES_MAX 8

#endif
