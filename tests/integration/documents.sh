#!/usr/bin/env bash
# The pages of this repository: relative links and their anchors resolve, lines are at most 120 characters outside code,
# tables, headings and links, all pages but the CHANGELOG together have at most 30 000 words, a decision at most 120, user
# pages end with what to read next, and the phrases that the glossary replaces stay away from pages and from what the
# programs say.
#   documents.sh SOURCE_DIR
set -euo pipefail
cd "$1"
export LC_ALL=C.UTF-8
most_words=30000
most_words_of_a_decision=120
longest_line=120
user_pages=(README.md CONTRIBUTING.md docs/*.md)
mapfile -t pages < <(printf '%s\n' "${user_pages[@]}" CHANGELOG.md; find docs -mindepth 2 -name '*.md' | sort)
faults=0
fault() { echo "$1"; faults=$((faults + 1)); }

# The lines of a page outside fenced code.
prose_of() { awk '/^ *```/ { code = !code; print ""; next } { print code ? "" : $0 }' "$1"; }

# The anchors that GitHub gives a page's headings: lower case, no punctuation, blanks as hyphens.
anchors_of() {
  prose_of "$1" | sed -nE 's/^#+ +//p' | sed -E 's/\[([^]]*)\]\([^)]*\)/\1/g' |
    tr '[:upper:]' '[:lower:]' | sed -E 's/[^[:alnum:] _-]//g; s/ /-/g'
}

for page in "${pages[@]}"; do
  folder=$(dirname "$page")
  while read -r link; do
    [[ $link =~ ^(https?|mailto): ]] && continue
    file=${link%%#*}
    anchor=
    [[ $link == *'#'* ]] && anchor=${link#*#}
    target=$page
    [ -z "$file" ] || target=$folder/$file
    [ -e "$target" ] || { fault "$page: link to $link: no such file"; continue; }
    [ -z "$anchor" ] || [[ $target != *.md ]] || anchors_of "$target" | grep -qxF -- "$anchor" ||
      fault "$page: link to $link: no such heading"
  done < <(prose_of "$page" | grep -oE '\]\([^) ]+\)' | sed -E 's/^\]\(|\)$//g' || true)
  while IFS=: read -r number line; do
    fault "$page:$number: ${#line} characters, at most $longest_line"
  done < <(prose_of "$page" | awk '/^ *\|/ || /^    / || /^#/ || /^ *!?\[[^]]*\]\([^)]*\)$/ { print ""; next } { print }' |
    grep -nE "^.{$((longest_line + 1)),}" || true)
done

# The category of NAMUR NE 107 of every kind of alarm is that of the code.
value_of() { sed -nE "s/.*std::string_view $1 = \"([a-z_]+)\";.*/\1/p" include/sealwatch/message/alarm_state.hpp; }
kinds=0
while read -r kind category; do
  [[ $kind != k[A-Z]* ]] || kind=$(value_of "$kind")
  kinds=$((kinds + 1))
  grep -qF "\`$kind\`" docs/reference/alarms.md || fault "docs/reference/alarms.md: \`$kind\` is missing"
  grep -qE "^\| ${category//_/ } \|.*\`$kind\`" docs/advisories.md ||
    fault "docs/advisories.md: NE 107, ${category//_/ }: \`$kind\` is missing"
done < <(sed -nE 's/^ *Ne107Row\{"?([A-Za-z_]+)"?, Ne107::([a-z_]+)\},$/\1 \2/p' include/sealwatch/message/ne107.hpp)
[ "$kinds" -gt 15 ] || fault "include/sealwatch/message/ne107.hpp: its table was not found"

words=$(cat "${user_pages[@]}" | wc -w)
behind=$(cat docs/{reference,records,decisions}/*.md | wc -w)
[ $((words + behind)) -le $most_words ] || fault "the pages have $((words + behind)) words, $behind of them in reference, records and decisions, at most $most_words: shorten, or move rows to a .tsv beside a record"
for page in docs/decisions/*.md; do
  length=$(wc -w < "$page")
  [[ $page == */README.md ]] || [ "$length" -le $most_words_of_a_decision ] ||
    fault "$page: $length words, at most $most_words_of_a_decision"
done
for page in docs/*.md; do
  tail -4 "$page" | grep -q '^Next: ' || fault "$page: does not end with what to read next (a paragraph that begins with 'Next: ')"
done

# Old phrases, and the terms of docs/glossary.md that stand for them.
phrases=(
  'in charge=primary forecaster' 'hollow=local minimum' 'are told=reported misfit' 'is told like=…'
  'elastic modulus when new=leakage-derived condition index' 'nobody knows when=…' 'costs the law=…'
  'with 80 % between=80 %: ... to ...' 'of late: =ageing has become' 'pretends one=looks like one' 'came true=held'
  'what came out=outputs' 'nothing that was tried=no alteration that was tried' 'lives more=more'
  'kept aside=held out' 'only teach=…' 'Master Control Station=Master Control System')
for pair in "${phrases[@]}"; do
  old=${pair%%=*}
  new=${pair#*=}
  while IFS= read -r hit; do fault "$hit: say '$new' (docs/glossary.md)"; done < <(
    {
      grep -nF -- "$old" "${pages[@]}" | grep -vE '^(docs/glossary|CHANGELOG)\.md:'
      # What a program says: between quotes, in sources of its own.
      grep -rnE --include='*.[ch]pp' -- "\"[^\"]*$old" services include
    } | cut -d: -f1,2 || true)
done

[ $faults -eq 0 ] || { echo "$faults faults"; exit 1; }
echo "${#pages[@]} pages, $words words in those for users, $behind behind them"
