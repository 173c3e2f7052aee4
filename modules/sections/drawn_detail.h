#pragma once
#include "model/stack.h"

namespace stackmesh {

/// Length or width of a typical contour, mm: the median over the contours' whole length.
double contour_extent_mm(const Stack& stack);

/// How thick the labels are where they are thin, in the plane: a twentieth of their contours' length sees no more of
/// its label before it; mm, infinite where nothing is seen.
double contour_wall_mm(const Stack& stack);

/// What stands for a pixel of drawn contours, mm: their typical edge, but where edges are long because little was drawn
/// (a box of four points) a 24th of a typical contour, less where walls are thin, not below a 64th.
double drawn_pixel_mm(const Stack& stack, double typical_edge_mm);

/// How far drawn outlines bulge over their own edges, mm: of an edge, an eighth of its length times the mean turn at
/// its ends, in radians (the height of the arc that turns as much); three quarters of the drawn contours' length bulge
/// no more. It tells how closely a smooth outline was drawn, and of a rough one how rough it is.
double drawn_bulge_mm(const Stack& stack);

/// The typical gap between drawn sections (not interpolated ones), mm; 0 if there are fewer than two.
double drawn_gap_mm(const Stack& stack);

}  // namespace stackmesh
