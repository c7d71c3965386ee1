/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/works/readers.h"
#include <string.h>

/* Element names by action, separated by spaces. */
static const struct {
    enum tei_act act;
    const char *names;
} elements[] = {
    {ACT_ROOT, "TEI TEI.2 teiCorpus text"},
    {ACT_HEADER, "teiHeader"},
    {ACT_BODY, "front body back"},
    {ACT_DIV, "div div0 div1 div2 div3 div4 div5 div6 div7 prologue epilogue performance"},
    {ACT_HEAD, "head titlePart"},
    {ACT_PARAGRAPH, "p ab byline dateline salute signed trailer docAuthor docImprint docDate docEdition "
                    "imprimatur addrLine u entry entryFree msItem layout handNote decoNote"},
    {ACT_ITEM, "item castItem person personGrp place org witness"},
    {ACT_ROW, "row"},
    {ACT_CELL, "cell"},
    {ACT_GROUP, "lg"},
    {ACT_LINE, "l"},
    {ACT_SPEECH, "sp"},
    {ACT_SPEAKER, "speaker"},
    {ACT_STAGE, "stage move sound camera tech view caption vocal kinesic incident"},
    {ACT_NOTE, "note"},
    {ACT_EMPHASIS, "emph hi title"},
    {ACT_FOREIGN, "foreign"},
    {ACT_NAME, "persName placeName name rs orgName geogName"},
    {ACT_PAGE, "pb"},
    {ACT_COLUMN, "cb gb handShift anchor"},
    {ACT_BREAK, "lb"},
    {ACT_SPACE, "milestone caesura space tagStart tagEnd"},
    {ACT_GAP, "gap"},
    {ACT_CHOICE, "choice app rdgGrp"},
    {ACT_EXPANSION, "expan"},
    {ACT_SIGN, "am"},
    {ACT_WORD, "w"},
    {ACT_POINT, "pc"},
    {ACT_REFERENCE, "ref"},
    {ACT_FIGURE, "figure"},
    {ACT_QUOTE, "q said"},
    {ACT_PASS, "quote cit seg s phr cl m c reg corr ex add supplied unclear lem rdg sic orig abbr "
               "date num author mentioned term gloss distinct soCalled subst forename surname roleName "
               "addName genName nameLink rhyme met ptr damage surplus secl g restore retrace measure "
               "measureGrp time country settlement region district bloc geogFeat idno formula ident code "
               "eg val att tag gi undo mod link linkGrp substJoin damageSpan addSpan delSpan alt altGrp "
               "join joinGrp pause shift lacunaStart lacunaEnd divGen mrow msup msub msqrt mfrac"},
    {ACT_APART, "group list table bibl opener closer epigraph floatingText titlePage docTitle label "
                "spGrp address street postCode postscript castList castGroup argument role roleDesc actor "
                "listPerson listPlace listOrg set desc publisher pubPlace editor biblScope imprint "
                "listBibl biblStruct email age sex birth death occupation math mi mn mo mtext "
                "witList form orth pron hyph syll gramGrp gram pos gen number case tns mood itype subc usg "
                "sense def etym lang xr re superEntry dictScrap msDesc msIdentifier repository institution "
                "collection altIdentifier msName msContents textLang incipit explicit rubric finalRubric "
                "colophon summary locus physDesc objectDesc supportDesc support extent dimensions height "
                "width depth dim foliation collation condition layoutDesc handDesc decoDesc bindingDesc "
                "binding musicNotation typeDesc typeNote scriptDesc sealDesc additions history origin "
                "origDate origPlace provenance acquisition additional adminInfo recordHist custodialHist "
                "surrogates msPart faith education nationality residence floruit event state trait "
                "monogr analytic series meeting"},
    {ACT_SKIP, "del fw metamark figDesc graphic media binaryObject standOff facsimile sourceDoc "
               "witDetail wit interp interpGrp span spanGrp index"},
};

static bool has_name(const char *names, const char *name, size_t size) {
    for (const char *at = names; (at = strstr(at, name)); at += size)
        if ((at == names || at[-1] == ' ') && (at[size] == ' ' || !at[size]))
            return true;
    return false;
}

enum tei_act tei_act_of(const char *name) {
    const size_t size = strlen(name);
    for (size_t i = 0; size && i < sizeof elements / sizeof *elements; i++)
        if (has_name(elements[i].names, name, size))
            return elements[i].act;
    return ACT_UNKNOWN;
}
