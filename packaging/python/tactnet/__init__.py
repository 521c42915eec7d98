"""Tools in Python for tactnet, the C++ library that recognises touched objects."""
