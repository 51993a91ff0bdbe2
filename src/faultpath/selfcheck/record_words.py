"""How the tables of whole records are worded."""

from faultpath.selfcheck.records import DYING, EXTENDED, LOPSIDED
from faultpath.selfcheck.rows import Shown, each

RECORDS = (
    Shown(
        LOPSIDED,
        "Audits of lopsided arms",
        "Share of audits with four paths that announce anything, where many scenes gain in one of "
        "the seeds and few lose in all, so that the mean difference is 0. Promised: at most .05.",
        each(
            ("scenes", "seeds", "scenes that gain", "announce"),
            lambda c: (str(c["scenes"]), str(c["seeds"]), f"{100 * float(c['gains']):g} %"),
        ),
    ),
    Shown(
        DYING,
        "Audits of which trials die",
        "Share of records that announce anything of equal arms, where the repair raises an error "
        "in a share of the trials that it fails under the shared fault. Promised: at most .05.",
        each(
            ("scenes", "failures that raise", "announce"),
            lambda c: (str(c["scenes"]), f"{100 * float(c['share']):g} %"),
        ),
    ),
    Shown(
        EXTENDED,
        "Audits that are extended after a look",
        "Share of records of equal arms that announce anything at one of several numbers of "
        "scenes, each looked at only if those before announced nothing; and of those, the ones "
        "without the finding that the audit was concluded before. Promised of these: at most .05.",
        each(("scenes", "finding", "announce"), lambda c: (str(c["scenes"]), str(c["finding"]))),
    ),
)
