# confusion: `counts` has a row per pair of classes that occurs: true class, recognised class, count, share of the true class.
# `names` are the classes on both axes, `caption` says what was counted. Shares in colour, the counts of mistakes in figures.
load "style.gnuplot"
eval begin("confusion", 640, 630)
n = words(names)
set xrange [-0.5:n - 0.5]
set yrange [n - 0.5:-0.5]
set for [i = 1:n] xtics add (word(names, i) i - 1) rotate by 60 right scale 0 font ",13"
set for [i = 1:n] ytics add (word(names, i) i - 1) scale 0 font ",13"
set xlabel "recognised class" offset 0,1.4
set ylabel "true class" offset 1.5
set lmargin 14
set rmargin 1.5
set tmargin 0.7
set bmargin 7.4
set border 15
unset grid
unset key
# A cell is the more opaque the larger its share: by the root, since few mistakes are to be seen too.
opacity(x) = x < 0.15 ? x / 0.15 * 0.21 : 0.21 + (x - 0.15) / 0.85 * 0.79
colour(share) = blue + (int(255 * (1 - opacity(sqrt(share))) + 0.5) << 24)
eval note(caption)
plot counts using 2:1:(0.5):(0.5):(colour($4)) with boxxyerror lc rgb variable, \
    "" using ($1 != $2 ? $2 : NaN):1:3 with labels tc rgb ink font ",12"
