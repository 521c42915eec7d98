# tactels: accuracy, time and multiply-adds of networks at many sizes. `sweep` has a row per network and size: series, tactels,
# rows × columns, accuracy on random and on blocked splits, µs, multiply-adds. `labels` has the sizes to name on the axis;
# `caption` says what was measured.
load "style.gnuplot"
eval begin("tactels", 640, 900)
set multiplot layout 3,1 margins 0.125,0.975,0.115,0.965 spacing 0,0.035
array series = ["TactNet-4", "TactNet-4 strided", "TactNet-6 economical"]
array hue = [orange, green, blue]
array mark = [5, 9, 7]
set logscale x
set xrange [82:1560]
set format x ""
set for [i = 1:words(labels)] xtics add ("" real(word(tactels, i)))
set for [i = 1:words(labels)] xtics add (word(labels, i) real(word(tactels, i)))
only(name, value) = strcol(1) eq name ? value : NaN

set ylabel "test accuracy, %" offset 1
set yrange [87:98.5]
set key bottom right samplen 2
set xtics format ""
set for [i = 1:words(labels)] xtics add ("" real(word(tactels, i)))
plot for [n = 1:3] sweep using 2:(only(series[n], $4)) with linespoints pt mark[n] ps 0.6 lw 1.6 lc rgb hue[n] title series[n], \
    for [n = 1:3] "" using 2:(only(series[n], $5)) with linespoints pt mark[n] ps 0.4 lw 1.2 dt (5,4) lc rgb hue[n] notitle, \
    NaN with lines lw 1.6 lc rgb ink title "random splits", NaN with lines lw 1.2 dt (5,4) lc rgb ink title "blocked splits"

unset key
set logscale y
set ylabel "µs per frame (log scale)" offset 1
set yrange [0.9:40]
set ytics (1, 2, 5, 10, 20)
plot for [n = 1:3] sweep using 2:(only(series[n], $6)) with linespoints pt mark[n] ps 0.6 lw 1.6 lc rgb hue[n]

set ylabel "multiply-adds (log scale)" offset 1
set yrange [6e4:3e6]
set ytics ("100 k" 1e5, "300 k" 3e5, "1 M" 1e6, "3 M" 3e6)
set xlabel "rows × columns (tactels on a log scale)" offset 0,-1.2
set xtics rotate by 45 right font ",12"
set for [i = 1:words(labels)] xtics add (word(labels, i) real(word(tactels, i)))
eval note(caption)
plot for [n = 1:3] sweep using 2:(only(series[n], $7)) with linespoints pt mark[n] ps 0.6 lw 1.6 lc rgb hue[n]
unset multiplot
