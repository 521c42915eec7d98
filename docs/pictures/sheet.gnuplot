# Makes one picture of the pictures in a folder, each with its name: touches.png and effects.png of this folder.
#   tactnet_touches output/touches
#   gnuplot -e "folder='output/touches'; sheet='docs/pictures/touches.png'; width=100; height=56; columns=8" docs/pictures/sheet.gnuplot
#   tactnet_effects output/effects
#   gnuplot -e "folder='output/effects'; sheet='docs/pictures/effects.png'; width=624; height=84; columns=2" docs/pictures/sheet.gnuplot
# Of each picture, width × height pixels inside the margin of 8 pixels are drawn: the first touch of a row, or all.
names = system("ls '".folder."'")
rows = int(ceil(words(names) / real(columns)))
cell = height + 30.0
set terminal pngcairo size columns * (width + 10), rows * cell font "DejaVu Sans,9"
set output sheet
set multiplot layout rows, columns margins 0.005, 0.995, 0.01, 1 - 20 / (rows * cell) \
    spacing 8.0 / (columns * (width + 10)), 24 / (rows * cell)
unset key
unset tics
unset border
set size ratio -1
set title offset 0,-0.8
set xrange [8:width + 7]
set yrange [8:height + 7]
do for [name in names] {
    set title system("basename '".name."' .png | tr _ ' '")
    plot folder."/".name binary filetype=png with rgbimage
}
unset multiplot
