#include "services/common/report/page.hpp"

#include <algorithm>
#include <cstddef>

#include "services/common/text/words.hpp"

namespace sealwatch::report {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

/// Bytes of the well-formed UTF-8 sequence that `text` begins with; 0: none (Unicode 15, table 3-7).
std::size_t sequence_length(std::string_view text) {
  const auto byte = [text](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U; };
  const auto follows = [&byte](std::size_t k) { return (byte(k) & 0xC0U) == 0x80U; };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return follows(1) ? 2 : 0;
  if (lead >= 0xE0 && lead <= 0xEF) {
    const bool overlong = lead == 0xE0 && byte(1) < 0xA0;
    const bool surrogate = lead == 0xED && byte(1) > 0x9F;
    return follows(1) && follows(2) && !overlong && !surrogate ? 3 : 0;
  }
  if (lead >= 0xF0 && lead <= 0xF4) {
    const bool overlong = lead == 0xF0 && byte(1) < 0x90;
    const bool beyond = lead == 0xF4 && byte(1) > 0x8F;
    return follows(1) && follows(2) && follows(3) && !overlong && !beyond ? 4 : 0;
  }
  return 0;
}

constexpr std::string_view kStyle = R"css(
:root{color-scheme:light dark;--page:#fff;--text:#1b1f24;--muted:#5c6670;--line:#d5dae0;--soft:#f3f5f7;--first:#0067a5;
--second:#c8500a;--third:#007a5a;--fourth:#a0509a;--bad:#b3261e;--good:#1a7f43;--warn:#9a6700;--metal:#e4e8ec}
@media (prefers-color-scheme:dark){:root{--page:#14181c;--text:#e4e8ec;--muted:#9aa5b0;--line:#39424b;--soft:#1d2329;
--first:#63b8f2;--second:#f0954e;--third:#45c79b;--fourth:#dd95d6;--bad:#ff8a80;--good:#5fce8c;--warn:#e5b75a;--metal:#2a323a}}
*{box-sizing:border-box}
body{margin:0 auto;padding:1.2rem 1.4rem 3rem;max-width:1180px;background:var(--page);color:var(--text);
font:15px/1.5 system-ui,"Segoe UI","DejaVu Sans",sans-serif}
h1{font-size:1.5rem;line-height:1.25;margin:.2rem 0 .1rem}h2{font-size:1.15rem;margin:2.2rem 0 .5rem;padding-bottom:.25rem;
border-bottom:1px solid var(--line)}h3{font-size:1rem;margin:1.3rem 0 .3rem}
p{margin:.4rem 0 .7rem;max-width:78ch}.muted{color:var(--muted)}.small{font-size:.86rem}
ul,ol{margin:.3rem 0 .8rem;padding-left:1.2rem;max-width:80ch}li{margin:.2rem 0}
code,.law{font-family:ui-monospace,"DejaVu Sans Mono",monospace;font-size:.92em}
.law{display:inline-block;background:var(--soft);padding:.3rem .6rem;border-radius:.3rem}
.banner{border-left:.45rem solid var(--muted);background:var(--soft);padding:.8rem 1.1rem;margin:.9rem 0 1.1rem;border-radius:.2rem}
.banner p{font-size:1.08rem;margin:.2rem 0;max-width:100ch}.banner.good{border-color:var(--good)}.banner.bad{border-color:var(--second)}
.banner.warn{border-color:var(--warn)}.verdict{font-weight:700;font-size:1.15rem}
.figures{display:flex;flex-wrap:wrap;gap:.6rem 2.2rem;margin:.7rem 0}.figures div{min-width:8rem}
.figures b{display:block;font-size:1.2rem}.figures span{color:var(--muted);font-size:.86rem}.figures b span{color:inherit;font-size:inherit}
.scroll{overflow-x:auto}table{border-collapse:collapse;margin:.5rem 0 1rem;font-size:.9rem;font-variant-numeric:tabular-nums}
td.prose{min-width:12rem}tr.strong td.prose{font-weight:400}th,td{padding:.28rem .7rem .28rem 0;text-align:left;vertical-align:top;border-bottom:1px solid var(--line)}
th{color:var(--muted);font-weight:600;vertical-align:bottom}th.n,td.n{text-align:right}.whole{white-space:nowrap}
tr.strong td{font-weight:600}.better{color:var(--good)}.worse{color:var(--bad)}
.plots{display:flex;flex-wrap:wrap;gap:.4rem 1.2rem}.plots>div{flex:0 0 auto;max-width:100%}
svg[role]{max-width:100%;height:auto;display:block}svg text{font:11px system-ui,"Segoe UI","DejaVu Sans",sans-serif;fill:var(--text)}
svg .tick{fill:var(--muted)}svg .named{paint-order:stroke;stroke:var(--page);stroke-width:3px;stroke-linejoin:round}svg .title{font-weight:600}svg .grid{stroke:var(--line);stroke-width:.6}
svg .paper{fill:var(--page)}
svg .frame{fill:none;stroke:var(--muted);stroke-width:.8}
.ink-foreground{--ink:var(--text)}.ink-muted{--ink:var(--muted)}.ink-first{--ink:var(--first)}.ink-second{--ink:var(--second)}
.ink-third{--ink:var(--third)}.ink-fourth{--ink:var(--fourth)}.ink-bad{--ink:var(--bad)}
.stroke{fill:none;stroke:var(--ink)}.fill{fill:var(--ink);stroke:none}.area{fill:var(--ink);fill-opacity:.18;stroke:none}
svg .part{fill:var(--metal);stroke:var(--muted);stroke-width:1.2}.hot{fill:var(--second);stroke:var(--second);stroke-width:2.2}
.same{stroke-dasharray:5 3}.symbol{fill:none;stroke:var(--text);stroke-width:1.2;pointer-events:none}.symbol .solid{fill:var(--text)}
.pipe{fill:none;stroke:var(--first);stroke-width:3;stroke-opacity:.55}.wire{fill:none;stroke:var(--muted);stroke-width:2}
.rod{fill:var(--metal);stroke:var(--muted)}.lead{fill:none;stroke:var(--muted);stroke-width:.8;stroke-dasharray:2 2}
svg .share{fill:var(--second);font-weight:700}svg .letters{font-size:10px}
.scroll{background:linear-gradient(90deg,var(--page) 40%,transparent) 0/2.5rem 100%,linear-gradient(270deg,var(--page) 40%,transparent) 100%/2.5rem 100%,
linear-gradient(90deg,var(--line),transparent) 0/.9rem 100%,linear-gradient(270deg,var(--line),transparent) 100%/.9rem 100%;
background-repeat:no-repeat;background-attachment:local,local,scroll,scroll}
@media (min-width:1001px){table:has(td.prose) td:not(.prose){white-space:nowrap}}
@media screen and (max-width:1000px){table{font-size:.8rem}th,td{padding-right:.5rem}td.prose{min-width:9rem}}
details{margin:.5rem 0}summary{cursor:pointer;color:var(--first)}
.part{margin:0}.part>summary{padding:.35rem 0;border-bottom:1px solid var(--line)}.part>summary h2{display:inline;border:0;
margin:0;font-size:1.02rem;color:var(--text)}.part>summary span{margin-left:.7rem;color:var(--muted);font-size:.86rem}
.screen{display:grid;grid-template-columns:minmax(0,5fr) minmax(0,7fr);gap:.4rem 1.6rem;align-items:start;margin:.2rem 0 .6rem}
.screen h2,.steps h2{margin:.2rem 0 .4rem;font-size:1.02rem}.screen h3{margin:.5rem 0 .2rem}.screen p{margin:.25rem 0}
.screen .drawing text{font-size:15px}.screen .drawing .letters{font-size:13px}
.steps{border-left:.45rem solid var(--first);background:var(--soft);padding:.5rem 1.1rem;margin:.6rem 0 1.2rem;border-radius:.2rem}
.steps h2{border:0;padding:0}.steps ol,.steps p{max-width:none;margin:.2rem 0}
@media screen and (max-width:800px){.screen{grid-template-columns:1fr}}
.narrow{display:none}.narrow>svg[role]{width:100%}
@media screen and (max-width:700px){.wide{display:none}.narrow{display:block}.scroll>svg[role]{max-width:none}}
@media print{:root{color-scheme:light;font-size:12px;--page:#fff;--text:#000;--muted:#444;--line:#bbb;--soft:#f3f3f3;--first:#0067a5;
--second:#c8500a;--third:#007a5a;--fourth:#a0509a;--bad:#b3261e;--good:#1a7f43;--warn:#9a6700;--metal:#e4e8ec}
@page{size:A4;margin:12mm}*{print-color-adjust:exact;-webkit-print-color-adjust:exact}
body{max-width:none;padding:0;font-size:12px;line-height:1.4}h1{font-size:15pt}h2{font-size:11pt;margin-top:1rem}p,ul,ol{max-width:none}
.plots>div,tr,.banner,.steps,.screen>div,.drawing{break-inside:avoid}h2,h3{break-after:avoid}summary{break-after:avoid;list-style:none}
details:not([open]):not(.paper){display:none}
.scroll{overflow:visible;background:none}table{font-size:8pt}.together{break-inside:avoid}thead{display:table-header-group}
td.n{white-space:nowrap}.figures{flex-wrap:nowrap;gap:.3rem 1.5rem;margin:.4rem 0}.figures div{min-width:0}.figures b{font-size:11pt}
.banner,.steps{padding:.4rem .8rem;margin:.5rem 0}.plots{gap:.2rem .8rem}.plots>div{width:48.5%}
svg[role]{width:100%}svg text{font-size:12px}}
)css";

/// What a drawing as a file of its own needs.
constexpr std::string_view kOnScreen = kStyle.substr(0, kStyle.find("@media print"));

/// The light colour of a variable of the style sheet; empty: it is no colour.
std::string_view light_colour(std::string_view name) {
  const std::string declared = std::string("--").append(name).append(":");
  const std::string_view light = kStyle.substr(0, kStyle.find("@media"));
  const std::size_t at = light.find(declared);
  if (at == std::string_view::npos) return {};
  const std::string_view value = light.substr(at + declared.size());
  return value.substr(0, value.find_first_of(";}"));
}

/// `text` with the light colour before each declaration that takes it from a variable: many viewers of SVG know no
/// variables and would draw in black.
std::string with_plain_colours(std::string_view text) {
  constexpr std::string_view kVariable = ":var(--";
  std::string plain;
  for (std::size_t at = text.find(kVariable); at != std::string_view::npos; at = text.find(kVariable)) {
    const std::size_t property = text.substr(0, at).find_last_of("{;\"") + 1;
    const std::size_t name = at + kVariable.size();
    const std::size_t end = text.find(')', name);
    const std::string_view colour = light_colour(text.substr(name, end - name));
    plain.append(text.substr(0, property));
    if (!colour.empty() && !text.substr(property).starts_with("--"))
      plain.append(text.substr(property, at - property)).append(":").append(colour).append(";");
    plain.append(text.substr(property, end - property));
    text.remove_prefix(end);
  }
  return plain.append(text);
}

/// What each ink colours, without the variable `--ink`.
std::string inks() {
  constexpr std::string_view kInk = "{--ink:var(--";
  std::string rules;
  for (std::size_t at = kOnScreen.find(kInk); at != std::string_view::npos; at = kOnScreen.find(kInk, at + 1)) {
    const std::size_t dot = kOnScreen.rfind('.', at);
    const std::string ink(kOnScreen.substr(dot, at - dot));
    const std::size_t name = at + kInk.size();
    std::string colour = "var(--";
    colour.append(kOnScreen.substr(name, kOnScreen.find(')', name) - name)).append(")}");
    rules.append(ink).append(".stroke{stroke:").append(colour);
    rules.append(ink).append(".fill,").append(ink).append(".area{fill:").append(colour).append("\n");
  }
  return rules;
}

/// What belongs on paper is opened for printing, and closed again; what its reader opened is printed as well.
constexpr std::string_view kScript =
    "let opened=[];"
    "addEventListener('beforeprint',()=>{opened=[...document.querySelectorAll('details.paper:not([open])')];"
    "opened.forEach(d=>d.open=true)});"
    "addEventListener('afterprint',()=>opened.forEach(d=>d.open=false))";

}  // namespace

std::string escaped(std::string_view text) {
  std::string html;
  html.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = sequence_length(text);
    const char letter = text.front();
    if (length == 0 || (length == 1 && static_cast<unsigned char>(letter) < ' ' && letter != '\n' && letter != '\t') ||
        letter == '\x7f')
      html += kReplacement;
    else if (letter == '&')
      html += "&amp;";
    else if (letter == '<')
      html += "&lt;";
    else if (letter == '>')
      html += "&gt;";
    else if (letter == '"')
      html += "&quot;";
    else if (letter == '\'')
      html += "&#39;";
    else
      html += text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return html;
}

std::string unbroken(std::string_view text) {
  constexpr std::string_view kDash = "\xE2\x80\x93";
  std::string html;
  while (!text.empty()) {
    const std::string_view bare = text.substr(0, text::end_of_word(text));
    const bool figures = bare.find_first_of("0123456789") != std::string_view::npos;
    const bool breaks =
        bare.find_first_of("- ") != std::string_view::npos || bare.find(kDash) != std::string_view::npos;
    if (figures && breaks)
      html.append("<span class=\"whole\">").append(bare).append("</span>");
    else
      html.append(bare);
    text.remove_prefix(bare.size());
    if (text.empty()) break;
    html += ' ';
    text.remove_prefix(1);
  }
  return html;
}

std::string html_page(std::string_view title, std::string_view body) {
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n";
  page.append("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>")
      .append(escaped(title))
      .append("</title>\n<style>")
      .append(kStyle)
      .append("</style>\n</head>\n<body>\n")
      .append(body)
      .append("\n<script>")
      .append(kScript)
      .append("</script>\n</body>\n</html>\n");
  return page;
}

std::string standalone_svg(std::string_view title, int width, int height, std::string_view body) {
  const std::string size = std::to_string(width) + " " + std::to_string(height);
  return with_plain_colours("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + std::to_string(width) +
                            "\" height=\"" + std::to_string(height) + "\" viewBox=\"0 0 " + size + "\">\n<title>" +
                            escaped(title) + "</title>\n<style>" + std::string(kOnScreen) + inks() +
                            "</style>\n<rect width=\"100%\" height=\"100%\" style=\"fill:var(--page)\"/>\n" +
                            std::string(body) + "</svg>\n");
}

std::string section(std::string_view title, std::string_view body) {
  return std::string("<section class=\"long\">\n<h2>")
      .append(escaped(title))
      .append("</h2>\n")
      .append(body)
      .append("</section>\n");
}

std::string folded_section(std::string_view title, std::string_view inside, std::string_view body, Paper paper) {
  return std::string("<section class=\"long\">\n<details class=\"part")
      .append(paper == Paper::printed ? " paper" : "")
      .append("\"><summary><h2>")
      .append(escaped(title))
      .append("</h2><span>")
      .append(escaped(inside))
      .append("</span></summary>\n")
      .append(body)
      .append("</details>\n</section>\n");
}

std::string paragraph(std::string_view text, std::string_view css_class) {
  std::string html = "<p";
  if (!css_class.empty()) html.append(" class=\"").append(css_class).append("\"");
  return html.append(">").append(escaped(text)).append("</p>\n");
}

std::string folded(std::string_view label, std::string_view body) {
  return std::string("<details><summary>")
      .append(escaped(label))
      .append("</summary>\n")
      .append(body)
      .append("</details>\n");
}

Table::Table(const std::vector<std::string>& headers) {
  for (const std::string& header : headers) {
    const bool right = header.starts_with(">");
    const bool prose = header.starts_with("~");
    classes_.emplace_back(right ? " class=\"n\"" : prose ? " class=\"prose\"" : "");
    head_.append(right ? "<th class=\"n\">" : "<th>")
        .append(escaped(header.substr(right || prose ? 1 : 0)))
        .append("</th>");
  }
}

void Table::row(const std::vector<std::string>& cells) {
  std::vector<std::string> html;
  html.reserve(cells.size());
  for (const std::string& cell : cells) html.push_back(escaped(cell));
  row_of_html(html);
}

void Table::row_of_html(const std::vector<std::string>& cells, std::string_view css_class) {
  rows_ += "<tr";
  if (!css_class.empty()) rows_.append(" class=\"").append(css_class).append("\"");
  rows_ += ">";
  for (std::size_t k = 0; k < cells.size(); ++k)
    rows_.append("<td")
        .append(k < classes_.size() ? classes_[k] : "")
        .append(">")
        .append(cells[k].find('<') == std::string::npos ? unbroken(cells[k]) : cells[k])
        .append("</td>");
  rows_ += "</tr>\n";
}

std::string Table::html() const {
  return std::string("<div class=\"scroll\"><table")
      .append(together_ ? " class=\"together\"" : "")
      .append(">\n<thead><tr>")
      .append(head_)
      .append("</tr></thead>\n<tbody>\n")
      .append(rows_)
      .append("</tbody>\n</table></div>\n");
}

}  // namespace sealwatch::report
