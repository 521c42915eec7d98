"""What all pictures share: themes, their colours and files, and SVG without what draws nothing."""
import re

themes = ("light", "dark")

# The colours of style.gnuplot, and the ground of a box.
colours = {
    "light": {"ink": "#24292f", "quiet": "#59636e", "rule": "#d8dee4", "panel": "#f6f8fa", "blue": "#0072b2",
              "orange": "#d55e00", "green": "#009e73"},
    "dark": {"ink": "#d6dce3", "quiet": "#9aa4af", "rule": "#3a424c", "panel": "#161b22", "blue": "#56b4e9",
             "orange": "#e69f00", "green": "#2fc597"},
}


def file_name(name, theme):
    return f"{name}{'_dark' if theme == 'dark' else ''}.svg"


def one_path(found):
    """Neighbouring polygons of one colour as one path."""
    colour = re.search(r"fill = '(#\w+)'(?: fill-opacity = '([\d.]+)')?", found[0])
    opacity = f" fill-opacity='{float(colour[2]):g}'" if colour[2] else ""
    corners = ("M" + " ".join(p.split()) + "z" for p in re.findall(r"points = '([^']*)'", found[0]))
    return f"<path stroke='none' fill='{colour[1]}'{opacity} d='{''.join(corners)}'/>"


def one_path_of_marks(found):
    """Neighbouring dots or crosses of one size and colour as one path."""
    mark, scale, colour = re.search(r"#gpPt(\d)'.*scale\(([\d.]+)\)' color='(#\w+)'", found[1]).groups()
    places = re.findall(r"translate\(([\d.]+),([\d.]+)\)", found[0])
    if mark == "6": # a line without length and with round ends
        return f"<path stroke='{colour}' stroke-width='{2.18 * float(scale):.2f}' stroke-linecap='round' d='" + \
            "".join(f"M{x} {y}h0" for x, y in places) + "'/>"
    r = float(scale)
    return f"<path stroke='{colour}' stroke-width='{0.3 * r:.2f}' d='" + "".join(
        f"M{float(x) - r:.2f} {float(y) - r:.2f}l{2 * r:.2f} {2 * r:.2f}m0-{2 * r:.2f}l-{2 * r:.2f} {2 * r:.2f}"
        for x, y in places) + "'/>"


def tidy(text):
    """What gnuplot and Graphviz write, without what draws nothing: a fifth of the size."""
    text = re.sub(r"<!--.*?-->|<desc>.*?</desc>|<title>(Gnuplot|gnuplot_plot_\w*|%0)</title>", "", text, flags=re.S)
    if "gnuplot_canvas" in text:
        text = re.sub(r"<filter.*?</filter>", "", text, flags=re.S)
        text = re.sub(r' class="gridline"| id="gnuplot_\w*"| font-family="[^"]*"', "", text)
        text = re.sub(r"<text><tspan[^>]*>(.*?)</tspan></text>", r"<text>\1</text>", text)
        text = re.sub(r' fill="none"| stroke-width="1.00"| stroke-linecap="butt"| stroke-linejoin="miter"', "", text)
        text = re.sub(r"<path[^>]*d='M[-\d.,]*\s*'/>|<rect x=\"0\"[^>]*/>|<text>\s*</text>", "", text)
        text = re.sub(r"rgb\(\s*(\d+),\s*(\d+),\s*(\d+)\s*\)", lambda m: "#%02x%02x%02x" % tuple(map(int, m.groups())), text)
        text = re.sub(r"(?<=\d)\.00(?=[ ,\"')])", "", text)
        text = re.sub(r'<g (transform="[^"]*") stroke="none" (fill=[^>]*)>\s*<text>(.*?)</text>\s*</g>',
                      r"<text \1 \2>\3</text>", text)
        text = re.sub(r"<polygon (fill = '#\w+'(?: fill-opacity = '[\d.]+')?) [^>]*/>(\s*<polygon \1 points[^>]*/>)+",
                      one_path, text)
        text = re.sub(r"(<use xlink:href='#gpPt[16]' transform='translate\([\d.,]+\) (scale\([\d.]+\)' color='#\w+')/>)"
                      r"(\s*<use xlink:href='#gpPt[16]' transform='translate\([\d.,]+\) \2/>)+", one_path_of_marks, text)
        text = re.sub(r'<g color="\w+" stroke="currentColor">\s*(<text [^<]*</text>)\s*</g>', r"\1", text)
        text = text.replace("<svg", '<svg font-family="Helvetica, Arial, sans-serif" fill="none"', 1)
        text = text.replace("<defs>", "<style>text{stroke:none}image{image-rendering:pixelated}</style>\n<defs>", 1)
        before = ""
        while before != text: # a group in a group, a mark made of a mark
            before = text
            text = re.sub(r"<(g|defs)[^>]*>\s*</\1>", "", text)
            text = re.sub(r"<(path|circle|rect|use)[^>]* id='(\w+)'[^>]*/>",
                          lambda m: m[0] if f"'#{m[2]}'" in before else "", text)
    return "\n".join(" ".join(line.split()) for line in text.splitlines() if line.strip()) + "\n"
