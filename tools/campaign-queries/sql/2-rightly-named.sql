-- Claim 2: of what was reported or had to be, at least 99 of 100 have the right name and axis. A verdict that is not in the list
-- counts neither way.
SELECT kind, encoder,
    count(*) FILTER (verdict = 'right') AS named,
    count(*) FILTER (verdict IN ('right', 'misnamed', 'missed')) AS counted,
    named / nullif(counted, 0) AS rate,
    lower_bound(named, counted) AS at_least,
    upper_bound(named, counted) AS at_most
FROM faulty GROUP BY GROUPING SETS ((kind, encoder), ()) ORDER BY kind, encoder;
