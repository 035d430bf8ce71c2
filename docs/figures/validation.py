"""The discretisation error that is left: the tables of results/refinement.md, drawn."""

from _common import GREY, ORANGE, TEAL, plt, save

# points: mean error left, mm, by Richardson extrapolation
LINEAR = {
    "gravity": {1257: 0.329, 9430: 0.179, 73003: 0.093},
    "pressure on a patch": {1257: 0.101, 9430: 0.049, 73003: 0.023},
}
AVERAGED = {"gravity": {5575: 0.146}, "pressure on a patch": {5575: 0.034}}
figure, axes = plt.subplots(figsize=(6.2, 3.8))
for (load, left), marker in zip(LINEAR.items(), "os", strict=True):
    axes.loglog(
        *zip(*left.items(), strict=True), f"{marker}-", c=ORANGE, label=f"tet4, {load}"
    )
for (load, left), marker in zip(AVERAGED.items(), "os", strict=True):
    axes.loglog(
        *zip(*left.items(), strict=True),
        marker,
        c=TEAL,
        ms=9,
        label=f"averaged, {load}",
    )
points = (1257, 73003)
axes.loglog(points, [0.2, 0.2 * (points[0] / points[1]) ** (1 / 3)], ":", c=GREY)
axes.loglog(points, [0.2, 0.2 * (points[0] / points[1]) ** (2 / 3)], ":", c=GREY)
axes.text(30000, 0.075, "order 1", color=GREY, fontsize=8)
axes.text(30000, 0.018, "order 2", color=GREY, fontsize=8)
axes.set(xlabel="points of the mesh", ylabel="mean error left, mm")
axes.set(xticks=[1000, 10000, 73000], yticks=[0.01, 0.03, 0.1, 0.3])
axes.set_xticklabels(["1,000", "10,000", "73,000"])
axes.set_yticklabels(["0.01", "0.03", "0.1", "0.3"])
axes.minorticks_off()
axes.legend(fontsize=8, loc="lower left")
save(figure, "validation")
