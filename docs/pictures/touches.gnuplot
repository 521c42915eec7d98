# Makes touches.png: one simulated touch per class of the paper, from the pictures that tactnet_touches draws.
#   tactnet_touches output/touches; gnuplot -e "touches='output/touches'; picture='docs/pictures/touches.png'" docs/pictures/touches.gnuplot
set terminal pngcairo size 880,270 font "DejaVu Sans,9"
set output picture
set multiplot layout 3,8 margins 0.005,0.995,0.01,0.93 spacing 0.008,0.08
unset key
unset tics
unset border
set size ratio -1
set title offset 0,-0.8
names = system("ls '".touches."'")
do for [name in names] {
    set title system("basename '".name."' .png | tr _ ' '")
    # The first of four touches, 100 × 56 pixels each, 8 apart. Rows count from the bottom.
    set xrange [8:107]
    set yrange [8:63]
    plot touches."/".name binary filetype=png with rgbimage
}
unset multiplot
