# The force of the three kinds of squeezes of docs/train/touches_over_time.md, whose program has the same formulas.
load "style.gnuplot"
eval begin("squeezes", 640, 250)
set multiplot layout 1,3 margins 0.06,0.98,0.3,0.84 spacing 0.05
one(t, peak) = t < peak ? t / peak : (1 - t) / (1 - peak)
set xrange [0:1]
set yrange [0:1.08]
unset xtics
set xlabel "time" offset 0,0.6
unset ytics
unset key
set samples 41
set ylabel "force" offset 1
eval note("Each recording has its own size, place, force and time. Read backwards, the first kind looks like the second.")
set title "quick grasp, slow release" offset 0,-0.5
plot one(x, 0.2) with filledcurves y1=0 fs transparent solid 0.2 lc rgb blue, one(x, 0.2) with lines lw 2 lc rgb blue
unset ylabel
unset label 99
set title "slow grasp, quick release" offset 0,-0.5
plot one(x, 0.8) with filledcurves y1=0 fs transparent solid 0.2 lc rgb orange, one(x, 0.8) with lines lw 2 lc rgb orange
set title "two squeezes" offset 0,-0.5
two(x) = one(2 * x - floor(2 * x), 0.5)
plot two(x) with filledcurves y1=0 fs transparent solid 0.2 lc rgb green, two(x) with lines lw 2 lc rgb green
unset multiplot
