# Draws the pictures of docs/decision.md from a table of benchmarks/results, in the folder docs/pictures:
#   gnuplot -e "results='../../benchmarks/results/zen5/2026-11-25/decision.md'; \
#       unknown='../../benchmarks/results/zen3/2026-11-26/decision.md'" decision.gnuplot
set datafile separator "|"
set terminal pngcairo size 700,420 font ",11"
set border 3 lc rgb "#8a8a86"
set tics nomirror
set grid y lc rgb "#d0d0cc" lw 0.5
set style fill solid
set key top left

set output "faults.png"
set style data histograms
set style histogram clustered gap 1
set ylabel "accuracy, %"
set yrange [0:115]
set ytics 0, 20, 100
set xtics rotate by 20 right
set rmargin 3
plot "< sed -n '/^| none |/,/^| 5 % of tactels dead/p' ".results \
    using 3:xtic(2) lc rgb "#c0504d" title "network alone", "" using 4 lc rgb "#1f5fa8" title "with the stage"

set output "unknown.png"
set style data lines
unset xrange
set xtics norotate
set ylabel "share of touches, %"
set yrange [0:*]
set ytics auto
set logscale x
set xrange [0.4:6]
set xtics (0.5, 1, 2, 3, 5)
set xlabel "distance to the nearest mean / spread of its class"
set key top left
plot "< sed -n '/^| distance \\/ spread, from/,/^$/p' ".unknown." | tail -n +3" \
    using 2:3 with fillsteps fs transparent solid 0.5 lc rgb "#1f5fa8" title "known objects", \
    "" using 2:4 with fillsteps fs transparent solid 0.5 lc rgb "#c0504d" title "unknown objects"
