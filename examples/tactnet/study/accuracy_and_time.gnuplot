# Test accuracy against time per frame: each method, the Pareto front, the paper.
#     gnuplot -c accuracy_and_time.gnuplot accuracy_and_time.csv > accuracy_and_time.png
set datafile separator ","
set datafile columnheaders
set datafile missing NaN
if (strstrt(GPVAL_TERMINALS, "pngcairo") > 0) { set terminal pngcairo size 1100,700 font ",11" noenhanced } \
else { set terminal png size 1100,700 noenhanced }
# Hues that colour-blind people can distinguish; grey for the paper.
array series = ["touches", "photographs", "machines", "paper", "front", "names"]
array title = ["networks for touches", "ImageNet-pretrained networks", "support vector machines", "the paper", \
    "Pareto front"]
array hue = [0x2a78d6, 0xd9622b, 0x199e70, 0x8a8a86, 0x2a78d6]
array mark = [7, 7, 7, 6]
array there[5]
do for [i = 1:5] {
    stats ARG1 using (strcol("series") eq series[i] ? 1 : 0) nooutput
    there[i] = STATS_sum
}
x(i) = strcol("series") eq series[i] ? column("x") : NaN
key(i) = there[i] > 0 ? title[i] : ""
stats ARG1 using (column("accuracy") - column("deviation")) nooutput
first = floor((STATS_min - 1) / 5) * 5
first = first < 0 ? 0 : first
stats ARG1 using "accuracy" nooutput
# Between 98 and 99 % half of all errors go, as between 80 and 90: the axis is stretched towards 100 %, so that halving
# the errors is the same height everywhere, unless something errs hardly at all.
last = STATS_max <= 99.4 ? 99.7 : 100
if (last < 100) {
    set nonlinear y via -log10(100.0 - y) inverse 100.0 - 10.0**(-y)
    set ytics (0, 20, 40, 50, 60, 70, 80, 90, 95, 97, 98, 99, 99.5)
}
below(y) = y > last ? last : y
stats ARG1 using "x" nooutput
set border 3 lc rgb "#8a8a86"
set tics nomirror
set grid lc rgb "#d0d0cc" lw 0.5
set logscale x
set xrange [0.015 * STATS_min:30 * STATS_max]
set xlabel "time per frame, one core (log scale)"
set xtics ("1 µs" 1, "10 µs" 10, "100 µs" 1e2, "1 ms" 1e3, "10 ms" 1e4, "100 ms" 1e5, "1 s" 1e6, "10 s" 1e7, "100 s" 1e8)
set yrange [first:last]
set ylabel last < 100 ? "test accuracy, % (errors on a log scale)" : "test accuracy, %"
set key opaque bottom right
plot ARG1 using (x(5)):"accuracy" smooth unique with steps lw 1.5 dt 2 lc rgb hue[5] title key(5), \
    for [i = 1:4] "" using (x(i)):"accuracy":(column("accuracy") - column("deviation")): \
        (below(column("accuracy") + column("deviation"))) with yerrorbars pt 7 ps 0 lc rgb 0xa0000000 + hue[i] notitle, \
    for [i = 1:4] "" using (x(i)):"accuracy" with points pt mark[i] ps 0.8 lc rgb hue[i] title key(i), \
    "" using (x(6)):"accuracy":"label" with labels right offset -0.8,0.5 font ",10" notitle
