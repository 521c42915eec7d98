# tactels: accuracy, time and multiply-adds of networks at many sizes. `sweep` has a row per network and size: series, tactels,
# rows × columns, accuracy on random and on blocked splits, µs, multiply-adds. `series` are the networks with slashes between
# them, `labels` the sizes and `tactels` their numbers of tactels; `caption` says what was measured.
load "style.gnuplot"
eval begin("tactels", 640, 960)
set multiplot layout 3,1 margins 0.135,0.97,0.125,0.93 spacing 0,0.025
array hue = [orange, blue, green]
array mark = [5, 7, 9]
array name[3]
n = 0
rest = series
while (strlen(rest) > 0) {
    end = strstrt(rest, "/")
    n = n + 1
    name[n] = rest[1:end - 1]
    rest = rest[end + 1:*]
}
set logscale x
set xrange [82:1560]
set format x ""
set xtics format "" ("" 91)
set mxtics 1
do for [i = 1:words(tactels)] { set xtics add ("" real(word(tactels, i))) }
only(series, value) = strcol(1) eq series ? value : NaN

set ylabel "test accuracy, %" offset 1
set yrange [85:98.5]
set key at screen 0.97,0.998 right top horizontal samplen 2 font ",13"
plot for [i = 1:n] sweep using 2:(only(name[i], $4)) with linespoints pt mark[i] ps 0.6 lw 1.6 lc rgb hue[i] title name[i], \
    for [i = 1:n] "" using 2:(only(name[i], $5)) with linespoints pt mark[i] ps 0.4 lw 1.2 dt (5,4) lc rgb hue[i] notitle, \
    NaN with lines lw 1.6 lc rgb ink title "random splits", NaN with lines lw 1.2 dt (5,4) lc rgb ink title "blocked"

unset key
set logscale y
set mytics 1
set ylabel "µs per frame (log scale)" offset 1
set yrange [0.8:40]
set ytics (1, 2, 5, 10, 20)
plot for [i = 1:n] sweep using 2:(only(name[i], $6)) with linespoints pt mark[i] ps 0.6 lw 1.6 lc rgb hue[i]

set ylabel "multiply-adds (log scale)" offset 2.2
set yrange [6e4:3e6]
set ytics ("100 k" 1e5, "300 k" 3e5, "1 M" 1e6, "3 M" 3e6)
set xlabel "rows × columns (tactels on a log scale)" offset 0,0.2
set xtics rotate by 45 right font ",12"
# Every other size: all would overlap.
do for [i = 1:words(labels)] { if (i == 20 || i % 2 == 1 && i < 19) { set xtics add (word(labels, i) real(word(tactels, i))) } }
eval note(caption)
plot for [i = 1:n] sweep using 2:(only(name[i], $7)) with linespoints pt mark[i] ps 0.6 lw 1.6 lc rgb hue[i]
unset multiplot
