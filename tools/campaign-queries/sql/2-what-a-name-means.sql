-- Which faults are behind a name, among those that a campaign draws: the latched fault, or the first that was reported where none latched.
WITH named AS (
    SELECT coalesce(fault, split_part(split_part(reported_faults, ' ', 1), '@', 1)) AS name,
        CASE WHEN encoder THEN 'encoder' ELSE 'index' END AS seen_by, kind AS cause
    FROM faulty WHERE coalesce(fault, reported_faults, '') <> ''
)
SELECT name, seen_by, cause, count(*) AS runs, count(*) / sum(count(*)) OVER (PARTITION BY name, seen_by) AS share
FROM named GROUP BY name, seen_by, cause ORDER BY name, seen_by, runs DESC, cause;
