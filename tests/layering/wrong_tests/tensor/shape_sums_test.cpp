// A topic of the header shape.
