s/^inline namespace TACTNET_ARCH \{$//
s/^\} \/\/ namespace TACTNET_ARCH$//
s/\) (.*)requires ([A-Za-z0-9_:<>, ]+)( :| *\{)/) \1requires (\2)\3/
s/^inline constexpr bool std::ranges::.*$//
