# A reliability diagram: of recognitions with about the same probability, how many are right; and how many there are.
eval terminal("700,900", "font ',11'")
set lmargin 10
set rmargin 3
set xrange [0:1]
set multiplot title ARG2
set size 1,0.7
set origin 0,0.27
set ylabel "share that is right"
set yrange [0:1]
set key left top
plot x with lines lc rgb "#8a8a86" dashtype 2 title "as often as the probability says", \
    ARG1 skip 1 using 1:2 with linespoints pt 6 lw 2 lc rgb "#c0504d" title "softmax", \
    "" skip 1 using 4:5 with linespoints pt 7 lw 2 lc rgb "#1f5fa8" title "at the fitted temperature"
set size 1,0.27
set origin 0,0
set xlabel "probability"
set ylabel "images"
set yrange [0:*]
unset key
plot ARG1 skip 1 using 1:3 with impulses lw 6 lc rgb "#c0504d", \
    "" skip 1 using 4:6 with impulses lw 3 lc rgb "#1f5fa8"
unset multiplot
