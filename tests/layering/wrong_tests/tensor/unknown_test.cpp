// There is no such header.
