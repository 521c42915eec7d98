"""What all pictures share: colours that follow the reader's choice of light or dark, and SVG without what draws nothing."""
import re
import xml.etree.ElementTree as ET

# The colours of style.gnuplot, and the ground of a box: as they are drawn, and what they become on a dark ground.
colours = {
    "ink": ("#24292f", "#d6dce3"), "quiet": ("#59636e", "#9aa4af"), "rule": ("#d8dee4", "#3a424c"),
    "panel": ("#f6f8fa", "#161b22"), "blue": ("#0072b2", "#56b4e9"), "orange": ("#d55e00", "#e69f00"),
    "green": ("#009e73", "#2fc597"), "purple": ("#a8508a", "#cc79a7"),
}
light = {name: colour for name, (colour, _) in colours.items()}


def follow_theme(picture):
    """Adds to an SVG, as text, a style that changes its colours where the reader prefers a dark ground."""
    rules = "".join(f'[{attribute}="{colour}"]{{{attribute}:{dark}}}' for colour, dark in colours.values()
                    for attribute in ("fill", "stroke", "color") if f' {attribute}="{colour}"' in picture)
    end = picture.index(">") + 1
    return f"{picture[:end]}\n<style>@media (prefers-color-scheme:dark){{{rules}}}</style>{picture[end:]}"


svg, xlink = "{http://www.w3.org/2000/svg}", "{http://www.w3.org/1999/xlink}"
ET.register_namespace("", svg[1:-1])
ET.register_namespace("xlink", xlink[1:-1])
# What an element has without being told.
defaults = {"fill": "none", "stroke-width": "1", "stroke-linecap": "butt", "stroke-linejoin": "miter", "font-weight": "normal"}


def path_of(element):
    """The outline of a polygon, or a dot or cross of gnuplot, as a path; None of anything else."""
    colour, width = element.get("fill"), None
    if element.tag == svg + "polygon" and element.get("stroke", "none") == "none":
        outline = "M" + " ".join(element.get("points").split()) + "z"
        return {"stroke": "none", "fill": colour, **{k: f"{float(v):g}" for k, v in element.items() if k == "fill-opacity"},
                "d": outline}
    found = re.fullmatch(r"translate\(([\d.]+),([\d.]+)\) scale\(([\d.]+)\)", element.get("transform", ""))
    if element.tag != svg + "use" or not found or element.get(xlink + "href") not in ("#gpPt1", "#gpPt6"):
        return None
    x, y, r = map(float, found.groups())
    if element.get(xlink + "href") == "#gpPt6": # a line without length and with round ends
        return {"stroke": element.get("color"), "stroke-width": f"{2.18 * r:.2f}", "stroke-linecap": "round",
                "d": f"M{x:g} {y:g}h0"}
    return {"stroke": element.get("color"), "stroke-width": f"{0.3 * r:.2f}",
            "d": f"M{x - r:.2f} {y - r:.2f}l{2 * r:.2f} {2 * r:.2f}m0-{2 * r:.2f}l-{2 * r:.2f} {2 * r:.2f}"}


def draws(element, name):
    """Whether an element shows anything."""
    if name == "title":
        return not re.match("Gnuplot|gnuplot_|%0", element.text or "")
    if name == "text":
        return bool((element.text or "").strip())
    return name not in ("desc", "filter") and not (name == "rect" and element.get("fill", "none") == "none") and \
        not (name == "path" and re.fullmatch(r"M[-\d.,]*\s*", element.get("d")))


def simplify(element):
    """Takes out of an element what draws nothing, and joins what looks alike."""
    children = []
    for child in element:
        if child.tag == svg + "text" and len(child) == 1: # a part of a text that is all of it
            child.text, child[:] = child[0].text, []
        simplify(child)
        if attributes := path_of(child):
            child = ET.Element(svg + "path", attributes)
        name = child.tag.removeprefix(svg)
        if name == "g" and len(child) == 1 and child[0].tag == svg + "text" and "transform" in child.keys():
            child[0].attrib.update((key, value) for key, value in child.items() if key != "stroke")
            child, name = child[0], "text"
        if name == "g" and (len(child) == 0 or not child.keys() and child[0].tag != svg + "title"):
            children += child
        elif draws(child, name):
            children.append(child)
    kept = []
    for child in children:
        # A path goes into the one like it before, if only words and other lines stand between.
        for one in reversed(kept) if child.tag == svg + "path" else ():
            if one.tag == child.tag and {**one.attrib, "d": ""} == {**child.attrib, "d": ""}:
                one.set("d", one.get("d") + child.get("d"))
                break
            if one.tag not in (svg + "text", svg + "path") or "stroke" not in child.keys() or child.get("stroke") == "none":
                kept.append(child)
                break
        else:
            kept.append(child)
    element[:] = kept
    element.tail = None
    if element.text and not element.text.strip():
        element.text = None
    for name, value in list(element.items()):
        value = re.sub(r"rgb\(\s*(\d+),\s*(\d+),\s*(\d+)\s*\)", lambda m: "#%02x%02x%02x" % tuple(map(int, m.groups())), value)
        value = " ".join(re.sub(r"(?<=\d)\.00\b|(?<=\.\d)0\b", "", value).split())
        if name in ("d", "points", "transform"): # a tenth of a pixel is enough
            value = re.sub(r"(?<=\.\d)\d+", "", value)
        # Everything in a group of gnuplot says its colour itself.
        if name in ("class", "font-family") or name == "id" and not value.startswith("gpPt") or defaults.get(name) == value or \
                element.tag in (svg + "g", svg + "text") and (name == "color" or (name, value) == ("stroke", "currentColor")):
            del element.attrib[name]
        else:
            element.set(name, value)


def tidy(text):
    """What gnuplot and Graphviz write, without what draws nothing: a fifth of the size. Titles of Graphviz's stay."""
    picture = ET.fromstring(re.sub(r"<!DOCTYPE[^>]*>", "", text))
    simplify(picture)
    used = ET.tostring(picture, encoding="unicode")
    for definitions in picture.findall(f".//{svg}defs"):
        for mark in reversed(list(definitions)): # one may be made of another before it
            if f'"#{mark.get("id")}"' not in used:
                definitions.remove(mark)
                used = ET.tostring(picture, encoding="unicode")
    picture.set("font-family", "Helvetica, Arial, sans-serif")
    picture.set("fill", "none")
    if picture.find(f".//{svg}image") is not None:
        style = ET.Element(svg + "style")
        style.text = "image{image-rendering:pixelated}"
        picture.insert(0, style)
    ET.indent(picture, "")
    return follow_theme(ET.tostring(picture, encoding="unicode")) + "\n"
