# Multiply-adds of networks at all sizes as a heat map; circles are the sizes of the paper.
#
#     tactnet_costs > costs.csv
#     gnuplot -c heat_map.gnuplot costs.csv costs.png
set terminal pngcairo size 1000,640 font "DejaVu Sans,10"
set output ARG2
set datafile separator ","
set multiplot layout 2,2 margins 0.055,0.865,0.085,0.94 spacing 0.05,0.13
set palette defined (0 "#fdf0c4", 0.3 "#f5a65b", 0.6 "#bf3f66", 0.85 "#5b2470", 1 "#1d1147")
set logscale cb
set cbrange [4e4:8e7]
set format cb "%.0s %c"
set tics scale 0.4 nomirror
set xrange [12.5:50.5]
set yrange [28.5:6.5]
set xtics (13, 18, 25, 35, 50)
set ytics (7, 10, 14, 20, 28)
set border 3 lw 0.6
array titles = ["TactNet-4", "TactNet-6, as published", "TactNet-6, economical", "TactResNet"]
$sizes << END
28,50
20,35
14,25
10,18
7,13
END
do for [n = 1:4] {
    set title titles[n] offset 0,-0.6
    if (n % 2 == 1) { set ylabel "rows" offset 1.5 } else { unset ylabel }
    if (n > 2) { set xlabel "columns" offset 0,0.5 } else { unset xlabel }
    if (n == 4) {
        set colorbox user origin 0.89,0.085 size 0.018,0.855
        set cblabel "multiply-adds a frame, on pixels" offset 0.5
    } else {
        unset colorbox
    }
    # 836 lines a network, one behind the other.
    plot ARG1 skip 1 every ::(836 * (n - 1))::(836 * n - 1) using 3:2:6 with image notitle, \
         $sizes using 2:1 with points pt 6 ps 1.6 lw 3 lc rgb "#ffffff" notitle, \
         $sizes using 2:1 with points pt 6 ps 1.6 lw 1 lc rgb "#1d1147" notitle
}
