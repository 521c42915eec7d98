# Test accuracy against time per frame: each method, the Pareto front, the paper.
#     cat ../reports/common.gnuplot accuracy.gnuplot accuracy_and_time.gnuplot | \
#         gnuplot -c /dev/stdin accuracy_and_time.csv > accuracy_and_time.png
# Hues that colour-blind people can distinguish; grey for the paper.
array name = ["touches", "photographs", "machines", "paper", "front", "names"]
array title = ["networks for touches", "ImageNet-pretrained networks", "support vector machines", "the paper", \
    "Pareto front"]
array hue = [0x2a78d6, 0xd9622b, 0x199e70, 0x8a8a86, 0x2a78d6]
array mark = [7, 7, 7, 6]
array there[5]
do for [i = 1:5] {
    stats ARG1 using (strcol("series") eq name[i] ? 1 : 0) nooutput
    there[i] = STATS_sum
}
key(i) = there[i] > 0 ? title[i] : ""
set logscale x
set xrange [0.015 * X_min:30 * X_max]
set xlabel "time per frame, one core (log scale)"
set xtics ("1 µs" 1, "10 µs" 10, "100 µs" 1e2, "1 ms" 1e3, "10 ms" 1e4, "100 ms" 1e5, "1 s" 1e6, "10 s" 1e7, "100 s" 1e8)
set yrange [first:last]
set ylabel last < 100 ? "test accuracy, % (errors on a log scale)" : "test accuracy, %"
plot ARG1 using (x(5)):"accuracy" smooth unique with steps lw 1.5 dt 2 lc rgb hue[5] title key(5), \
    for [i = 1:4] "" using (x(i)):"accuracy":(column("accuracy") - column("deviation")): \
        (below(column("accuracy") + column("deviation"))) with yerrorbars pt 7 ps 0 lc rgb 0xa0000000 + hue[i] notitle, \
    for [i = 1:4] "" using (x(i)):"accuracy" with points pt mark[i] ps 0.8 lc rgb hue[i] title key(i), \
    "" using (x(6)):"accuracy":"label" with labels right offset -0.8,0.5 font ",10" notitle
