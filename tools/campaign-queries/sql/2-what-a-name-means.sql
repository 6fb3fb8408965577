-- Which causes are behind a name, among the faults that a campaign draws: the latched fault, or the first that was reported where none
-- latched. A motor that turns back by itself is reversed, whichever kind of fault drew it. The sense is that in which the cause moves a
-- crank; lost steps and slips have positive sizes behind.
WITH named AS (
    SELECT coalesce(fault, split_part(split_part(reported_faults, ' ', 1), '@', 1)) AS name,
        CASE WHEN encoder THEN 'encoder' ELSE 'index' END AS seen_by,
        CASE WHEN kind = 'runaway' AND size <= 0 THEN 'reversed' ELSE kind END AS cause,
        CASE WHEN kind IN ('lost-steps', 'slip') THEN if(size > 0, 'behind', 'ahead')
            WHEN kind = 'runaway' AND size > 0 THEN 'ahead'
            WHEN kind IN ('runaway', 'stuck', 'reversed') THEN 'behind' ELSE '' END AS sense
    FROM faulty WHERE coalesce(fault, reported_faults, '') <> ''
)
SELECT name, seen_by, sense, cause, count(*) AS runs, count(*) / sum(count(*)) OVER (PARTITION BY name, seen_by) AS share
FROM named GROUP BY name, seen_by, sense, cause ORDER BY name, seen_by, runs DESC, cause, sense;
