# faults, unknown and reliability, from tables of benchmarks/results: `faults` (fault, accuracy alone, with the stage),
# `distances` (from, known, unknown), `diagram` (what `tactnet evaluate` writes as reliability CSV).
load "style.gnuplot"

eval begin("faults", 640, 400)
set yrange [7.6:-0.6]
set ytics scale 0
set border 1
set grid noytics
set xrange [0:100]
set xtics 0, 20
set xlabel "test accuracy, %"
set lmargin 24
set rmargin 3
set tmargin 2.3
set bmargin 5
set key at screen 0.55,0.99 center top horizontal maxrows 1
eval note("TactNet-6 at 28×50; 4400 test images of 20 blocked splits of the paper's 1100 images.")
plot faults using (0):($0 - 0.18):(0):2:($0 - 0.34):($0 - 0.02):yticlabels(1) with boxxyerror lc rgb orange title "network alone", \
    "" using (0):($0 + 0.18):(0):3:($0 + 0.02):($0 + 0.34) with boxxyerror lc rgb blue title "with sensor_health and gain_monitor"
reset

load "style.gnuplot"
eval begin("unknown", 640, 360)
set yrange [0:19]
set ytics 0, 5
set ylabel "share of touches, %"
set logscale x
set xrange [0.35:6]
set xtics (0.5, 1, 2, 3, 5)
set xlabel "distance to the nearest class mean ÷ spread of its class (log scale)"
set tmargin 1
set rmargin 3
set bmargin 5
unset key
set label 1 "known objects" at 0.7,14.2 center tc rgb blue
set label 2 "unknown objects" at 2.9,16.8 center tc rgb orange
eval note("TactNet-6 trained on 17 of the paper's 22 objects, 20 draws of the other five; blocked splits.")
plot distances using 1:2 with fillsteps fs transparent solid 0.35 lc rgb blue, \
    "" using 1:3 with fillsteps fs transparent solid 0.35 lc rgb orange, \
    "" using 1:2 with steps lw 2 lc rgb blue, "" using 1:3 with steps lw 2 lc rgb orange
reset

if (!exists("diagram")) { exit }
load "style.gnuplot"
eval begin("reliability", 640, 560)
set lmargin 11
set rmargin 3
set xrange [0:1]
set xtics 0, 0.2
set multiplot
set size 1,0.66
set origin 0,0.34
set tmargin 1
set bmargin 2
set ylabel "share that is right"
set yrange [0:1]
set ytics 0, 0.2
set key left top
enough = 10 # of fewer images a share says little
plot x with lines lc rgb quiet dt (6,4) title "calibrated", \
    diagram skip 1 using ($3 >= enough ? $1 : NaN):2 with linespoints pt 6 ps 0.8 lw 2 lc rgb orange title "softmax", \
    "" skip 1 using ($6 >= enough ? $4 : NaN):5 with linespoints pt 7 ps 0.8 lw 2 lc rgb blue title "after temperature scaling"
set size 1,0.34
set origin 0,0
set tmargin 0.5
set bmargin 5
set xlabel "probability of the recognised class"
set ylabel "images"
set yrange [0:*]
set ytics 0, 2000
unset key
eval note("TactNet-6 at 28×50; 4400 test images of 20 blocked splits; points of at least ".enough." images.")
plot diagram skip 1 using ($1 - 0.008):3 with impulses lw 6 lc rgb orange, \
    "" skip 1 using ($4 + 0.008):6 with impulses lw 6 lc rgb blue
