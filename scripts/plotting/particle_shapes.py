# SPDX-License-Identifier: LGPL-2.1-or-later
"""Particles as ellipsoids that are stretched as the material around them."""

import math

import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkStaticPointLocator

# A neighbour at the start that has gone farther than so many times its distance is torn off.
TORN = 2.5
# No axis is drawn longer than so many radii, nor shorter than one over it.
LARGEST_STRETCH = 2

DISC = numpy.array([[numpy.cos(angle), numpy.sin(angle)]
                    for angle in numpy.linspace(0, 2 * numpy.pi, 12, endpoint=False)])


def particle_sizes(grid):
    """Sides of the cubes, or squares, that hold the particles' volumes."""
    points = grid.initial_points()
    dim = dimension_of(points)
    if "volume" in grid.point_data:
        volume = numpy.abs(grid.point_data["volume"]).reshape(-1)
    else:
        extents = numpy.ptp(points, axis=0)[:dim]
        volume = numpy.full(len(points), numpy.prod(extents) / len(points))
    return volume**(1 / dim)


def dimension_of(points):
    return 2 if not len(points) or numpy.ptp(points[:, 2]) == 0 else 3


class Neighbours:
    """Those of each point at the start, (n, k); kept while the points are the same."""
    points, numbers = None, None

    @classmethod
    def of(cls, points, count):
        if cls.points is None or not numpy.array_equal(cls.points, points):
            cls.points, cls.numbers = points.copy(), cls.find(points, count)
        return cls.numbers

    @staticmethod
    def find(points, count):
        cloud_points = vtkPoints()
        cloud_points.SetData(numpy_to_vtk(numpy.ascontiguousarray(points), deep=True))
        cloud = vtkPolyData()
        cloud.SetPoints(cloud_points)
        locator = vtkStaticPointLocator()
        locator.SetDataSet(cloud)
        locator.BuildLocator()
        numbers, found = numpy.empty((len(points), count), dtype=int), vtkIdList()
        for point, position in enumerate(points):
            locator.FindClosestNPoints(count, position, found)
            numbers[point] = [found.GetId(k) for k in range(count)]
        return numbers


def stretches(start, now):
    """Left stretch tensors (n, 3, 3) of the motion of points to their present positions, by least squares over the
    neighbours at the start that are not torn off; the identity where too few are left. Their determinant is 1."""
    dim, n = dimension_of(start), len(start)
    count = min(n, 9 if dim == 2 else 19)
    result = numpy.tile(numpy.eye(3), (n, 1, 1))
    if count <= dim + 1:
        return result
    numbers = Neighbours.of(start, count)
    before = (start[numbers] - start[:, None])[:, :, :dim]
    after = (now[numbers] - now[:, None])[:, :, :dim]
    length = numpy.linalg.norm(before, axis=2)
    with numpy.errstate(divide="ignore", invalid="ignore"):
        weight = ((numpy.linalg.norm(after, axis=2) < TORN * length) / length**2)
    weight[~numpy.isfinite(weight)] = 0
    square = numpy.einsum("nk,nki,nkj->nij", weight, before, before)
    mixed = numpy.einsum("nk,nki,nkj->nij", weight, after, before)
    is_known = numpy.isfinite(mixed).all(axis=(1, 2)) & (numpy.linalg.cond(square) < 100)
    gradient = mixed[is_known] @ numpy.linalg.inv(square[is_known])
    turn, size, _ = numpy.linalg.svd(gradient)
    size = numpy.maximum(size, 1e-3 * size.max(axis=1, initial=1e-300, keepdims=True))
    size /= numpy.prod(size, axis=1, keepdims=True)**(1 / dim)
    # What flows without end is shown less stretched than it is, with its volume.
    logarithm = numpy.log(size)
    largest = numpy.abs(logarithm).max(axis=1, initial=0, keepdims=True)
    size = numpy.exp(logarithm * numpy.minimum(1, math.log(LARGEST_STRETCH) / numpy.maximum(largest, 1e-300)))
    rows = numpy.flatnonzero(is_known)[:, None, None]
    result[rows, numpy.arange(dim)[:, None], numpy.arange(dim)] = (turn * size[:, None, :]) @ turn.transpose(0, 2, 1)
    return result


def particle_shapes(grid, magnify=1):
    """Symmetric matrices A (n, 3, 3) of the ellipsoids c + A s, |s| = 1, which have the particles' volumes."""
    start = grid.initial_points()
    share = numpy.pi**-0.5 if dimension_of(start) == 2 else (4 / 3 * numpy.pi)**(-1 / 3)
    shapes = stretches(start, start + magnify * (grid.points - start))
    if "broken bonds" in grid.point_data:  # what has no bond left has no shape
        shapes[grid.point_data["broken bonds"].reshape(-1) >= 1] = numpy.eye(3)
    return share * particle_sizes(grid)[:, None, None] * shapes


def outlines(shapes, matrix):
    """Square roots (n, 2, 2) of the ellipses that the ellipsoids are in a parallel view: c + S d, |d| = 1. The rows of
    the matrix are those of the view."""
    turned = matrix[:2] @ shapes
    square = turned @ turned.transpose(0, 2, 1)
    root = numpy.sqrt(numpy.maximum(numpy.linalg.det(square), 0))
    trace = numpy.trace(square, axis1=1, axis2=2)
    return (square + root[:, None, None] * numpy.eye(2)) / numpy.sqrt(trace + 2 * root)[:, None, None]


def silhouettes(shapes, matrix):
    """Polygons (n, 12, 3) of the ellipsoids in a view, from their centres; the third column is how far they reach
    towards the viewer."""
    result = numpy.empty((len(shapes), len(DISC), 3))
    result[:, :, :2] = numpy.einsum("nij,kj->nki", outlines(shapes, matrix), DISC)
    # An ellipsoid reaches out of the face that its centre lies on.
    result[:, :, 2] = numpy.linalg.norm(matrix[2] @ shapes, axis=1)[:, None]
    return result
