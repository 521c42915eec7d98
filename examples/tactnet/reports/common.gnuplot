# What comes before every picture's own script: a table, names, the size and the style. In this folder:
#     cat common.gnuplot confusion.gnuplot | gnuplot -c /dev/stdin confusion.csv TITLE NAME/NAME/… > confusion.png
set datafile separator ","
set datafile missing NaN
set datafile commentschars "" # a name may begin with one
# The names in ARG3 end with a slash each.
array name[1000]
n = 0
rest = ARG3
while (strlen(rest) > 0) {
    n = n + 1
    end = strstrt(rest, "/")
    name[n] = rest[1:end - 1]
    rest = rest[end + 1:*]
}
# A terminal with a font, if it has fonts.
terminal(size, font) = strstrt(GPVAL_TERMINALS, "pngcairo") > 0 \
    ? sprintf("set terminal pngcairo size %s %s noenhanced", size, font) : sprintf("set terminal png size %s noenhanced", size)
eval terminal("1100,700", "font ',11'")
set border 3 lc rgb "#8a8a86"
set tics nomirror
set grid lc rgb "#d0d0cc" lw 0.5
