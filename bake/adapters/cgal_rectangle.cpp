/* cgal_rectangle.cpp - the minimal-area rectangle by CGAL's convex hull and rotating calipers.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/adapters/cgal_rectangle.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <CGAL/convex_hull_2.h>
#include <CGAL/min_quadrilateral_2.h>

#include <cmath>
#include <vector>

#include "bake/adapters/adapter_barrier.h"

namespace
{

using kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using point = kernel::Point_2;

void set_axis(double x, double y, double axis[2])
{
    double length = std::sqrt(x * x + y * y);
    axis[0] = length > 0.0 ? x / length : 1.0;
    axis[1] = length > 0.0 ? y / length : 0.0;
}

void find_axis(size_t count, const double (*points)[2], double axis[2])
{
    std::vector<point> all, hull;
    all.reserve(count);
    for (size_t i = 0; i < count; i++) {
        all.emplace_back(points[i][0], points[i][1]);
    }
    CGAL::convex_hull_2(all.begin(), all.end(), std::back_inserter(hull));
    if (hull.size() < 3) {
        set_axis(hull.empty() ? 0.0 : hull.back().x() - hull.front().x(),
                 hull.empty() ? 0.0 : hull.back().y() - hull.front().y(), axis);
        return;
    }
    CGAL::Polygon_2<kernel> rectangle;
    CGAL::min_rectangle_2(hull.begin(), hull.end(), std::back_inserter(rectangle));
    set_axis(rectangle[1].x() - rectangle[0].x(), rectangle[1].y() - rectangle[0].y(), axis);
}

} // namespace

parian_result parian_minimal_rectangle(const parian_env *env, size_t count,
                                       const double (*points)[2], double axis[2])
{
    return parian::guard(env, "CGAL minimal rectangle", PARIAN_E_COMPUTE, [&] {
        find_axis(count, points, axis);
        return PARIAN_OK;
    });
}
