# Loss and validation accuracy of trainings, epoch by epoch: three columns of the table for each.
#     gnuplot -c learning_curves.gnuplot curves.csv png "" NAME/NAME/… > curves.png
set datafile separator ","
set datafile missing NaN
if (ARG2 eq "svg") { set terminal svg size 900,600 dynamic font "sans-serif,13" noenhanced } \
else { if (strstrt(GPVAL_TERMINALS, "pngcairo") > 0) { set terminal pngcairo size 1100,700 font ",11" noenhanced } \
else { set terminal png size 1100,700 noenhanced } }
set border 3 lc rgb "#8a8a86"
set tics nomirror
set grid lc rgb "#d0d0cc" lw 0.5
# The names in ARG4 end with a slash each.
array name[1000]
n = 0
rest = ARG4
while (strlen(rest) > 0) {
    n = n + 1
    end = strstrt(rest, "/")
    name[n] = rest[1:end - 1]
    rest = rest[end + 1:*]
}
validated = 0
do for [i = 1:n] {
    stats ARG1 skip 1 using 1:3 * i - 1 nooutput
    longest = i == 1 || STATS_max_x > longest ? STATS_max_x : longest
    shortest = i == 1 || STATS_max_x < shortest ? STATS_max_x : shortest
    undefine STATS_*
    stats ARG1 skip 1 using 3 * i + 1 nooutput
    if (exists("STATS_records")) { validated = validated + STATS_records }
}
set multiplot layout 1,(validated > 0 ? 2 : 1)
set xlabel "epoch"
if (longest > 4 * shortest) { set logscale x }
set logscale y
set ylabel validated > 0 ? "loss (dashed: training, solid: validation)" : "training loss"
if (validated == 0) {
    plot for [i = 1:n] ARG1 skip 1 using 1:3 * i - 1 with lines lw 1.5 lc i title name[i]
} else {
    plot for [i = 1:n] ARG1 skip 1 using 1:3 * i - 1 with lines lw 1.5 dt 2 lc i notitle, \
        for [i = 1:n] "" skip 1 using 1:3 * i with lines lw 1.5 lc i notitle
    unset logscale y
    set ylabel "accuracy on validation images, %"
    set yrange [:100]
    set key bottom right opaque
    plot for [i = 1:n] ARG1 skip 1 using 1:(100 * column(3 * i + 1)) with lines lw 1.5 lc i title name[i]
}
unset multiplot
