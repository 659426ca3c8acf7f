# SPDX-License-Identifier: LGPL-2.1-or-later
"""The scenes of contact between bodies against their closed forms; called by
scripts/plot_body_contact."""

import sys
from pathlib import Path

import numpy
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from . import fields, style
from .results import Field, PlotError, Results

BARS = [("colliding_bars", "elements on elements", style.ELEMENT_COLOUR, "-"),
        ("particles_on_elements", "particles on elements", style.PARTICLE_COLOUR, "-"),
        ("particles_on_particles", "particles on particles", "#2f8f4e", "--")]


def draw_bars(directory, path):
    """Force in the joint and momentum of both bars over time; E = rho = c = 1, area 3, length 50,
    speed 0.01, gap 0.5."""
    speed, length, area, gap = 0.01, 50., 3., 0.5
    force, momentum = 0.5 * speed * area, speed * length * area
    begin = gap / speed
    figure, (left, right) = style.panels(2, 2, 4.4, 3.)
    left.plot([0, begin, begin, begin + 2 * length, begin + 2 * length, 260],
              numpy.array([0, 0, 1, 1, 0, 0]) * force, color=style.EXACT_COLOUR, label="exact")
    rows = []
    for name, label, colour, line in BARS:
        if not (directory / name).is_dir():
            continue
        results = Results(directory / name)
        table, parts = results.table("contact.csv"), results.table("parts.csv")
        left.plot(table["time"], -table["joint mean force x"], line, color=colour, label=label)
        for part in ("left", "right"):
            right.plot(parts["time"], parts[f"{part} momentum x"], line, color=colour)
        time, impulse = table["time"], -table["joint impulse x"]
        mean_time = (numpy.diff(impulse) * (time[1:] + time[:-1]) / 2).sum() / impulse[-1]
        middle = (time > begin + 15) & (time < begin + 85)
        mean = numpy.polyfit(time[middle], impulse[middle], 1)[0]
        rows += [(f"two bars, {label}: impulse", impulse[-1], momentum),
                 (f"two bars, {label}: force", mean, force),
                 (f"two bars, {label}: time of contact", 2 * (mean_time - begin), 2 * length)]
    # A wave of a constant force turns the momentum linearly.
    times = [0, begin, begin + 2 * length, 260]
    for ends in ((1, 1, 0, 0), (0, 0, 1, 1)):
        right.plot(times, numpy.array(ends) * momentum, color=style.EXACT_COLOUR, linewidth=0.8)
    left.set(xlabel="time", ylabel="force in the joint")
    right.set(xlabel="time", ylabel="momentum of left and right bar")
    style.legend_above(figure, dict(zip(*reversed(left.get_legend_handles_labels()))))
    return rows, style.save(figure, path)


def draw_cylinders(directory, path):
    """Pressure and stress on the axis of two cylinders; mm and GPa, R = 10, 0.1 kN/mm."""
    modulus, poisson, radius, load = 70., 0.3, 10., 0.1
    effective = 0.5 * modulus / (1 - poisson**2)
    half = numpy.sqrt(4 * load * (radius / 2) / (numpy.pi * effective))
    largest = 2 * load / (numpy.pi * half)
    results = Results(directory / "hertz_cylinders")
    grid = results.grids_at(results.times(None)[-1])["cells"]
    position, force = grid.initial_points(), grid.point_data["contact force"][:, 1]
    surface = numpy.flatnonzero((force > 0) & (position[:, 1] >= 0))
    surface = surface[numpy.argsort(position[surface, 0])]
    x, force = position[surface, 0], force[surface]
    spacing = x[1] - x[0]
    tributary = numpy.full(len(x), spacing)
    tributary[0] *= 0.5
    pressure = force / tributary
    width = 2 * numpy.sqrt(numpy.sum(force * x**2) / numpy.sum(force))
    rows = [("two cylinders: half width [mm]", width, half),
            ("two cylinders: largest pressure [MPa]", 1e3 * pressure[0], 1e3 * largest)]

    figure, (left, right) = style.panels(2, 2, 4.4, 3.2)
    exact = numpy.linspace(0, half, 200)
    left.plot(1e3 * exact, 1e3 * largest * numpy.sqrt(1 - (exact / half)**2),
              color=style.EXACT_COLOUR, label="Hertz")
    left.plot(1e3 * x, 1e3 * pressure, "o", markersize=4, color=style.ELEMENT_COLOUR,
              label="elements")
    left.set(xlabel="distance from the middle [µm]", ylabel="pressure [MPa]", ylim=(0, None))
    middle, stress = grid.samples("stress")
    on_axis = (middle[:, 0] < 0.6 * spacing) & (middle[:, 1] > 0) & (middle[:, 1] < 6 * half)
    order = numpy.flatnonzero(on_axis)[numpy.argsort(middle[on_axis, 1])]
    depth = numpy.linspace(0, 6 * half, 300)
    ratio, root = depth / half, numpy.sqrt(1 + (depth / half)**2)
    for exact, component, colour, text in (
            (-1 / root, 1, style.ELEMENT_COLOUR, "along"),
            (-((1 + 2 * ratio**2) / root - 2 * ratio), 0, style.PARTICLE_COLOUR, "across")):
        right.plot(depth, 1e3 * largest * exact, color=style.EXACT_COLOUR)
        right.plot(middle[order, 1], 1e3 * stress[order, component], "o", markersize=4,
                   color=colour, label=text)
    right.set(xlabel="depth below the middle [mm]", ylabel="stress [MPa]")
    left.legend()
    right.legend()
    return rows, style.save(figure, path)


def heat_in_one_dimension(times, share, n_cells=80, n_steps=1000):
    """Temperature of the middle of a plate of 2 mm between half-spaces at 500 degrees, by implicit
    finite volumes; the pressure is the share of 1e4 Pa that the middle has, and comes on in 5 ms."""
    end, half_plate, die = times[-1], 1e-3, 10e-3
    step = end / n_steps
    sizes = numpy.r_[numpy.full(n_cells, half_plate / n_cells), numpy.full(n_cells, die / n_cells)]
    conductivity = numpy.repeat([175., 60.], n_cells)
    capacity = numpy.repeat([2700. * 875., 7850. * 434.], n_cells) * sizes
    temperature = numpy.repeat([20., 500.], n_cells)
    links = 1 / (0.5 * sizes[:-1] / conductivity[:-1] + 0.5 * sizes[1:] / conductivity[1:])
    resistance = 1 / links[n_cells - 1]
    seen, result = 0, []
    for index in range(1, n_steps + 1):
        time = index * step
        h = 2e4 * min(1., share * min(time / 0.005, 1.))
        links[n_cells - 1] = 1 / (resistance + (1 / h if h > 0 else 1e30))
        matrix = numpy.diag(capacity / step)
        band = numpy.arange(len(links))
        matrix[band, band] += links
        matrix[band + 1, band + 1] += links
        matrix[band, band + 1] -= links
        matrix[band + 1, band] -= links
        temperature = numpy.linalg.solve(matrix, capacity / step * temperature)
        while seen < len(times) and time >= times[seen] - 0.5 * step:
            result.append(temperature[0])
            seen += 1
    return numpy.array(result)


def draw_plate(directory, path):
    """The temperature of plate and dies, and of the middle of the plate over time."""
    results = Results(directory / "pressed_plate")
    times = numpy.array(results.times(None))
    table = results.table("contact.csv")
    rows = [(f"plate: force on the side {side} [N/m]", abs(table[f"{side} mean force y"][-1]), 160.)
            for side in ("below", "above")]
    last = results.grids_at(times[-1])
    position = last["particles"].initial_points()
    in_middle = numpy.abs(position[:, 0]) < 1e-6
    centre = numpy.flatnonzero(in_middle & (numpy.abs(position[:, 1] - 1e-3) < 1e-6))[0]
    force = numpy.abs(last["particles"].point_data["contact force"][:, 1])
    near = (numpy.abs(position[:, 0]) < 2.1e-3) & (position[:, 1] > 1.9e-3)
    share = numpy.sum(force[near]) / (numpy.count_nonzero(near) * 0.5e-3) / 1e4
    measured = [results.grids_at(time)["particles"].point_data["nodal temperature"][centre]
                for time in times]
    computed = heat_in_one_dimension(times, share)
    rows += [("plate: pressure in the middle of the upper side [Pa]", 1e4 * share, 1e4),
             ("plate: temperature in the middle at 0.05 s", measured[-1], computed[-1])]

    figure, (left, right) = style.panels(2, 2, 4.6, 3.2)
    field = Field("nodal temperature")
    norm = Normalize(20, 500)
    camera = fields.Camera([1, 1, 0])
    fields.draw_body(left, last, field, camera, norm, "inferno", 1)
    left.set_aspect("equal")
    left.grid(False)
    for axis in (left.xaxis, left.yaxis):
        axis.set_major_formatter(lambda value, _: f"{1e3 * value:g}")
    left.set(xlabel="x [mm]", ylabel="y [mm]")
    figure.colorbar(ScalarMappable(norm, "inferno"), ax=left, location="top", shrink=0.8,
                    label="temperature [°C] at 0.05 s")
    right.plot(numpy.r_[0, times], numpy.r_[20, computed], color=style.EXACT_COLOUR,
               label="in one dimension")
    right.plot(numpy.r_[0, times], numpy.r_[20, measured], "o", color=style.PARTICLE_COLOUR,
               markersize=4, label="particles")
    right.set(xlabel="time [s]", ylabel="middle of the plate [°C]")
    right.legend()
    return rows, style.save(figure, path)


def main():
    directory = Path(sys.argv[1] if len(sys.argv) > 1 else "output/contact")
    pictures = Path(sys.argv[2]) if len(sys.argv) > 2 else directory / "pictures"
    scenes = [("colliding_bars", draw_bars, "bars.png"),
              ("hertz_cylinders", draw_cylinders, "cylinders.png"),
              ("pressed_plate", draw_plate, "plate.png")]
    scenes = [scene for scene in scenes if (directory / scene[0]).is_dir()]
    if not scenes:
        sys.exit(f"plot_body_contact: {directory} has none of the scenes")
    pictures.mkdir(parents=True, exist_ok=True)
    print("| what | computed | theory | difference |\n|---|---|---|---|")
    try:
        for _, draw, picture in scenes:
            rows, path = draw(directory, pictures / picture)
            for what, computed, theory in rows:
                print(f"| {what} | {computed:.5g} | {theory:.5g} | "
                      f"{100 * (computed / theory - 1):+.2f} % |")
            print(path, file=sys.stderr)
    except PlotError as error:
        sys.exit(f"plot_body_contact: {error}")


if __name__ == "__main__":
    main()
