# tactels: accuracy, time and multiply-adds of networks against the number of tactels. `networks` is a table that
# scripts/pictures makes of the study's rows: network, tactels, random and blocked accuracy in percent, µs, thousands of
# multiply-adds. `processor` is what they were measured on, `splits` how many of each kind, `names` end with a slash each.
load "style.gnuplot"
array name[4]
n = 0
rest = names
while (strlen(rest) > 0) {
    n = n + 1
    end = strstrt(rest, "/")
    name[n] = rest[1:end - 1]
    rest = rest[end + 1:*]
}
array hue = [purple, orange, blue, green]
array mark = [5, 9, 7, 13]
of(i) = strcol(1) eq name[i] ? $2 : NaN
eval begin("tactels", 640, 860)
set multiplot layout 3,1 margins 0.125,0.975,0.095,0.985 spacing 0,0.045
set logscale x
set xrange [85:1500]
set xtics ("" 91, "" 180, "" 350, "" 700, "" 1400)
set key bottom right

set nonlinear y via -log10(100.0 - y) inverse 100.0 - 10.0**(-y)
set yrange [80:99.2]
set ytics (80, 85, 90, 93, 95, 97, 98, 99)
set ylabel "test accuracy, % (errors on a log scale)"
plot for [i = 1:n] networks using (of(i)):3 with linespoints pt mark[i] ps 0.6 lw 2 lc rgb hue[i] title name[i], \
    for [i = 1:n] "" using (of(i)):4 with lines lw 1.5 dt (5,4) lc rgb hue[i] notitle, \
    NaN with lines lw 1.5 dt (5,4) lc rgb quiet title "blocked splits"
unset nonlinear y

set logscale y
unset key
set yrange [*:*]
set ytics (1, 2, 5, 10, 20, 50, 100)
set ylabel "µs per frame"
plot for [i = 1:n] networks using (of(i)):5 with linespoints pt mark[i] ps 0.6 lw 2 lc rgb hue[i]

set ytics ("0.1 M" 100, "0.2 M" 200, "0.5 M" 500, "1 M" 1000, "2 M" 2000)
set ylabel "multiply-adds"
set xtics ("91\n7×13" 91, "180\n10×18" 180, "350\n14×25" 350, "700\n20×35" 700, "1400\n28×50" 1400)
set xlabel "tactels" offset 0,0.3
eval note(sprintf("Mean of %d random and %d blocked splits. One core, batch 1, %s.", splits, splits, processor))
plot for [i = 1:n] networks using (of(i)):6 with linespoints pt mark[i] ps 0.6 lw 2 lc rgb hue[i]
unset multiplot
