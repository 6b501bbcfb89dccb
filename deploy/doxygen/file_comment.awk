# Shows Doxygen the comment at the head of a header, its equations and tables as they stand.
NR == 1 && /^\/\// { print "/** @file"; print "@verbatim"; head = 1 }
head && /^\/\// { sub(/^\/\/ ?/, ""); gsub(/\*\//, "* /"); print; next }
head { print "@endverbatim */"; head = 0 }
{ print }
