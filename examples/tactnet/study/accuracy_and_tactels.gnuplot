# Test accuracy against the number of tactels, of methods at several sizes.
#     gnuplot -c accuracy_and_tactels.gnuplot accuracy_and_tactels.csv "" METHOD/METHOD/… > accuracy_and_tactels.png
set datafile separator ","
set datafile columnheaders
if (strstrt(GPVAL_TERMINALS, "pngcairo") > 0) { set terminal pngcairo size 1100,700 font ",11" noenhanced } \
else { set terminal png size 1100,700 noenhanced }
# The names in ARG3 end with a slash each.
array name[1000]
n = 0
rest = ARG3
while (strlen(rest) > 0) {
    n = n + 1
    end = strstrt(rest, "/")
    name[n] = rest[1:end - 1]
    rest = rest[end + 1:*]
}
x(i) = strcol("series") eq name[i] ? column("x") : NaN
stats ARG1 using (column("accuracy") - column("deviation")) nooutput
first = floor((STATS_min - 1) / 5) * 5
first = first < 0 ? 0 : first
stats ARG1 using "accuracy" nooutput
last = STATS_max <= 99.4 ? 99.7 : 100
if (last < 100) { # as in accuracy_and_time.gnuplot
    set nonlinear y via -log10(100.0 - y) inverse 100.0 - 10.0**(-y)
    set ytics (0, 20, 40, 50, 60, 70, 80, 90, 95, 97, 98, 99, 99.5)
}
below(y) = y > last ? last : y
stats ARG1 using "x" nooutput
set border 3 lc rgb "#8a8a86"
set tics nomirror
set grid lc rgb "#d0d0cc" lw 0.5
set logscale x 2
set xrange [0.8 * STATS_min:1.25 * STATS_max]
set xlabel "tactels"
set xtics STATS_min, 2
set yrange [first:last]
set ylabel "test accuracy, %"
set key opaque bottom right
plot for [i = 1:n] ARG1 using (x(i)):"accuracy" smooth unique with lines lw 1.5 lc i notitle, \
    for [i = 1:n] "" using (x(i)):"accuracy":(column("accuracy") - column("deviation")): \
        (below(column("accuracy") + column("deviation"))) with yerrorbars pt 4 + i % 10 ps 0.8 lc i title name[i]
