/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/dialogue_internal.h"
#include <stddef.h>
#include <string.h>

static const struct dialogue_words list[] = {
    {.lang = "en",
     .articles = " the a an his her my our their ",
     .endings = " ing ",
     .manner = " with in without after ",
     .quote = "",
     .verbs =
         " said says asked cried replied answered exclaimed whispered murmured muttered shouted called "
         "returned "
         "continued added remarked observed inquired enquired demanded declared began repeated interrupted "
         "explained suggested sighed screamed interposed rejoined ejaculated responded retorted protested "
         "agreed "
         "announced begged urged pursued resumed gasped growled sobbed snapped stammered faltered admitted "
         "insisted persisted concluded commented roared panted cautioned objected pleaded queried laughed "
         "grumbled hissed groaned yelled wailed drawled mumbled proceeded ventured echoed chuckled ",
     .male = " mr m sir lord captain colonel major uncle monsieur king prince duke master count father ",
     .female = " mrs miss ms lady aunt madame mademoiselle queen princess duchess mistress countess mother ",
     .titles = " dr doctor professor judge reverend cousin ",
     .between = " the then at last poor old young little dear again here now ",
     .pronouns = " i he she they we you it who one ",
     .before =
         " to of with at for from by upon on in about after before than and or like towards toward into as ",
     .others = " i he she they we you it the a an and but then when while as so no yes oh ah well his her "
               "their my our "
               "your this that these those there here what who which how why where if in on at to of for "
               "with by from "
               "after before not never now once only all both one two some every everybody everyone nobody "
               "somebody "
               "god heaven lord just even still yet or nor said asked at him them it's at's mr mrs miss ms "
               "dr sir lady "
               "perhaps having at again next all each another his's at's thus such nothing something during "
               "without "},
    {.lang = "it",
     .articles = " il lo la l i gli le un una uno ",
     .endings = " ndo ato ata ito ita uto uta ",
     .manner = " con senza dopo quasi mentre ",
     .quote = "",
     .verbs = " disse dice diceva risponde rispose rispondeva chiese chiedeva domandò domandava esclamò "
              "esclamava gridò "
              "gridava mormorò mormorava sussurrò soggiunse aggiunse replicò ripeté ripetè ripigliò riprese "
              "continuò "
              "proseguì interruppe fece urlò balbettò borbottò osservò concluse ordinò spiegò ribatté "
              "ribattè insistette "
              "insisté insistè sospirò cominciò confermò annunciò annunziò brontolò supplicò implorò ammise "
              "protestò "
              "commentò interrogò salutò avvertì disser dissero fé rispondea dicea ",
     .male = " don signor signore sior padre fra frate conte dottor dottore principe maestro zio compare re "
             "duca ",
     .female =
         " donna signora signorina madre suor suora contessa principessa comare zia regina marchesa monna ",
     .titles = " san santo santa ",
     .between = " allora poi subito infine il lo la l gli le mi ti ci vi si ancora anche pure quasi tosto "
                "invece finalmente "
                "però intanto ",
     .pronouns = " io lui lei egli ella noi loro chi questi quegli costui colei costei colui quella quello ",
     .before =
         " a ad ed al allo alla all ai agli alle di del dello della dell con per da dal dalla dall su sul "
         "sulla tra fra "
         "verso e ed ",
     .others =
         " il lo la i gli le un uno una e ed ma poi allora quando mentre come così no sì oh ah io tu lui lei "
         "egli "
         "ella esso essa noi voi loro questo questa quello quella che chi cosa dove perché se in a al di da "
         "con "
         "per non mai ora una volta tutti tutto ognuno nessuno qualcuno dio signore subito intanto quindi "
         "dopo prima "
         "anche pure però ebbene già ecco gli disse dice rispose si sua suo l dopo appena qui là l'altro "},
    {.lang = "pt",
     .articles = " o a os as um uma ",
     .endings = " ndo ado ada ido ida ",
     .manner = " com sem depois quasi quase emquanto enquanto ao ",
     .quote = "",
     .verbs =
         " disse diz dizia respondeu respondia perguntou perguntava exclamou exclamava gritou gritava "
         "murmurou "
         "sussurrou acrescentou replicou retorquiu tornou continuou prosseguiu interrompeu bradou balbuciou "
         "observou concluiu ordenou explicou insistiu suspirou começou confirmou anunciou ponderou acudiu "
         "redarguiu "
         "volveu atalhou emendou repetiu pediu fez indagou declarou comentou resmungou confessou interveio "
         "segredou protestou aconselhou rosnou inquiriu ",
     .male = " senhor sr snr seu padre frei conde doutor dr tio compadre rei barão comendador ",
     .female = " dona d senhora sra snra madre condessa tia comadre rainha sinhá baronesa nhá irmã ",
     .titles = " são santa mestre primo ",
     .between = " então logo o lhe me nos se afinal enfim ainda também assim lhes por fim ",
     .pronouns = " eu ele ela nós eles elas quem elle ella elles ellas este esta esse essa aquele aquela "
                 "aquelle aquella ",
     .before = " a à ao aos às de do da dos das com para pra por em no na e ",
     .others =
         " o a os as um uma e mas então quando enquanto como assim não sim oh ah eu tu ele ela eles elas nós "
         "vós "
         "este esta esse essa aquele aquela isto isso que quem onde porque se em ao de do da com para por "
         "nunca agora "
         "tudo todos ninguém alguém deus senhor logo depois antes também já eis lhe disse seu sua aqui ali "
         "nem ora pois só foi era você "},
    {.lang = "tr",
     .articles = " ",
     .endings = " ",
     .manner = " ",
     .quote = "diye",
     .verbs =
         " dedi der diyor diyordu derdi sordu soruyordu bağırdı haykırdı fısıldadı mırıldandı yanıtladı "
         "cevapladı "
         "söylendi seslendi ekledi atıldı inledi söyledi tekrarladı bağırıyordu cevap karşılık yanıt devam "
         "homurdandı kekeledi çıkıştı gürledi ",
     .male = " bey efendi paşa ağa amca dayı usta hoca çavuş reis bay ",
     .female = " hanım hanımefendi teyze abla hala bacı nine bayan kadın ",
     .titles = " doktor kaptan ",
     .between = " diye ona bana verdi etti edip verip hemen birden sonra yine gene da de bu kez ",
     .pronouns = " o ben biz onlar ",
     .before = " ",
     .others = " o bu şu ben sen biz siz onlar ve ama fakat sonra bir her hiç kimse herkes ne niçin neden "
               "nasıl nerede evet "
               "hayır allah tanrı belki şimdi artık diye dedi sonunda birden bunun onun yok var ah oh demek "
               "öyle böyle ",
     .verb_last = true},
};

const struct dialogue_words *dialogue_words_of(const char *lang) {
    for (size_t i = 0; lang && i < sizeof list / sizeof *list; i++)
        if (!strncmp(lang, list[i].lang, 2) && (!lang[2] || lang[2] == '-' || lang[2] == '_'))
            return &list[i];
    return NULL;
}

bool dialogue_word_in(const char *words, const char *word) {
    const size_t size = strlen(word);
    for (const char *at = words; size && (at = strstr(at, word)); at += size)
        if (at > words && at[-1] == ' ' && at[size] == ' ')
            return true;
    return false;
}
