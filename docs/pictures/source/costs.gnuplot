# costs: multiply-adds of four networks at all sizes, as a heat map; circles are the sizes of the paper. `costs` is what
# tactnet_costs prints.
load "style.gnuplot"
eval begin("costs", 640, 480)
set multiplot layout 2,2 margins 0.095,0.86,0.18,0.935 spacing 0.055,0.14
# Viridis (van der Walt and Smith, 2015), which has the same order of lightness for everyone.
set palette maxcolors 48 defined (0 "#fde725", 0.25 "#5ec962", 0.5 "#21918c", 0.75 "#3b528b", 1 "#440154")
set logscale cb
set cbrange [4e4:8e7]
set cbtics ("0.1 M" 1e5, "1 M" 1e6, "10 M" 1e7)
set xrange [12.5:50.5]
set yrange [28.5:6.5]
unset grid
set tics scale 0.4 font ",13"
set xtics (13, 18, 25, 35, 50)
set ytics (7, 10, 14, 20, 28)
array titles = ["TactNet-4", "TactNet-6", "TactNet-6 economical", "TactResNet"]
$sizes << END
28,50
20,35
14,25
10,18
7,13
END
do for [n = 1:4] {
    set title titles[n] offset 0,-0.7
    if (n % 2 == 1) { set ylabel "rows" offset 1 tc rgb ink } else { unset ylabel }
    if (n > 2) { set xlabel "columns" offset 0,0.4 tc rgb ink } else { unset xlabel }
    if (n == 4) {
        set colorbox user origin 0.885,0.18 size 0.025,0.755 noborder
        eval note("Colour: multiply-adds per frame (log scale). Circles: sizes of the paper.")
    } else {
        unset colorbox
    }
    # 836 lines per network, one after the other.
    plot costs skip 1 every ::(836 * (n - 1))::(836 * n - 1) using 3:2:6 with image notitle, \
         $sizes using 2:1 with points pt 7 ps 0.8 lc rgb 0xffffff notitle, \
         $sizes using 2:1 with points pt 6 ps 0.8 lc rgb 0x000000 notitle
}
