s/^namespace tactnet \{ inline namespace TACTNET_ARCH \{/namespace tactnet {/
s/^\}(\}+ \/\/ namespace tactnet)/\1/
s/\) (.*)requires ([A-Za-z0-9_:<>, ]+)( :| *\{)/) \1requires (\2)\3/
s/^inline constexpr bool std::ranges::.*$//
