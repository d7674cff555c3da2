# What the window says in Japanese; config/languages/en/window.ftl holds the English of every message.

language-name = 日本語
    .latin = Japanese

## Keys that are held with another one

key-ctrl = Ctrl
key-alt = Alt
key-shift = Shift

## Words that many places share

off = オフ
none = なし
cancel = キャンセル
reset = リセット
undo = 元に戻す
redo = やり直す
open = 開く
export = エクスポート
length-mm = { $value } mm
area-mm2 = { $value } mm²
volume-mm3 = { $value } mm³
time-ms = { $value } ms
percent = { $value } %
size-bytes = { $value } B
size-kilobytes = { $value } kB
size-megabytes = { $value } MB
triangles = 三角形 { $count } 枚
both-keys = { $first } と { $second }
name-with-keys = { $name } ({ $keys })

## Pages at the right

page-look = 表示
    .about = 粘土の見え方
page-scene = シーン
    .about = 2 つ目のオブジェクト、ブーリアン、詳細レベル、トリム
page-walls = 壁
    .about = 壁の厚みと薄い箇所
page-measure = 寸法
    .about = 計測、方向ごとの影、ほかの形状との距離
page-files = ファイル
    .about = 開く、エクスポート、画像
page-devices = ペン
    .about = デバイスと現在の値
page-loop = ループ
    .about = 計算ループとこのウィンドウの所要時間
page-more = その他
    .about = プリファレンスとメッセージ

## Brushes

kind-gaussian = ガウス
    .about = 面の法線方向に釣鐘形に盛り上げます (Cipollini 2020)。
kind-smooth = スムーズ
    .about = 面をならします。余接重みのラプラシアンで、強さは 1 回のダブで進む割合です。
kind-draw = ドロー
    .about = 減衰に従い、面を平均法線の方向に盛り上げます。
kind-clay = クレイ
    .about = 平らな層で粘土を盛ります。面の少し上の平面まで埋めます。
kind-clay-strips = クレイストリップ
    .about = 端が四角い平らな帯で、ストロークに沿って粘土を置きます。
kind-inflate = インフレート
    .about = 形を膨らませます。各頂点は自身の法線方向に動きます。
kind-layer = レイヤー
    .about = 何度通っても 1 ストロークで一定の高さの層を作ります。
kind-crease = クリース
    .about = 両側が寄った溝を刻みます。反転すると稜線になります。
kind-pinch = ピンチ
    .about = 面をブラシの中心に寄せます。反転すると広げます。
kind-blob = ブロブ
    .about = 丸い滴を盛り上げます。面は下の一点から膨らみます。
kind-flatten = フラット化
    .about = 凸部と凹部を平均平面に寄せます。反転すると強調します。
kind-fill = フィル
    .about = 凹部を平均平面まで埋め、凸部は残します。反転すると凸部を下げます。
kind-scrape = スクレイプ
    .about = 凸部を平均平面まで削り、凹部は残します。反転すると凹部を埋めます。
kind-trim = トリム
    .about = 面の少し下の平面から出ている部分を、ナイフのように切り落とします。
kind-grab = グラブ
    .about = ペンを下ろしたときにブラシの下にあった部分がペンに付いて動きます。
kind-elastic = エラスティック
    .about = 一点で支えた弾性体のように粘土を動かします (正則化 Kelvinlet、de Goes と James 2017)。
kind-topological = トポロジー
    .about = グラブと同じですが、空間ではなく面に沿って近い部分をつかみます。
kind-snake-hook = スネークフック
    .about = 粘土をペンの後に引き出し、それに付いていきます。
kind-twist = ツイスト
    .about = ペンが右に動くと、ブラシの下にあった部分を法線まわりに回します。
kind-thumb = サム
    .about = ブラシの下にあった部分を面に沿って伸ばします。
kind-nudge = ナッジ
    .about = ストロークとともに面を押します。
kind-relax = リラックス
    .about = 形を保ち、面に沿って三角形をそろえます。
kind-mask = マスク
    .about = 塗った部分をほかのブラシから保護します。反転すると解除します。
kind-mask-blur = マスクぼかし
    .about = マスクの境界をぼかします。反転すると鋭くします。
kind-paint = ペイント
    .about = ブラシの色を粘土に塗ります。
kind-texture = テクスチャ
    .about = アルファをストロークに沿って曲げ、繰り返しながら浮き彫りにします。
kind-density = 密度
    .about = 三角形をブラシに対する希望の大きさにそろえます。形は変わりません。
kind-simplify = 簡略化
    .about = 小さな三角形をブラシに対する希望の大きさまでまとめます。大きなものと形は残ります。
kind-slide-relax = スライド緩和
    .about = 形を保ち、ストロークとともに三角形を面に沿って滑らせます。Shift または反転でリラックスします。
kind-plane = 平面
    .about = 凸部と凹部を、ストローク開始時の面の平均平面に寄せます。反転すると強調します。
kind-multiplane-scrape = 2 面スクレイプ
    .about = ストロークに沿って交わる 2 平面を削り、平らな側面の稜線を残します。
kind-sharpen = シャープ
    .about = 細かい凹凸を際立たせます。反転すると弱めます。
kind-surface-smooth = 面スムーズ
    .about = 体積を保って面をならします (Taubin 1995)。
kind-boundary = 境界
    .about = 開いた面の境界がペンに付いて動き、その奥の面も動きます。
kind-erase-layer = レイヤー消去
    .about = アクティブなレイヤーの効果を取り除き、下の面に戻します。
kind-draw-face-sets = 面セット描画
    .about = 面セットを描きます。ストロークごとに新しいセット。反転では始点のセットを続けます。

## Numbers of single brushes

number-depth = 深さ
    .blob = その点が面の下どこまで下がるか (半径単位)
    .plane = 層が平面の下どこまで届くか (半径単位)
    .trim = 面の下どこまで切るか (半径単位、最大の強さで)
number-lift = 持ち上げ
    .about = 平面が面の上どこにあるか (半径単位、最大の強さで)
number-fill = フィル
    .about = 半径の 5 分の 1 進むごとに平面へ近づく割合
number-roundness = 丸み
    .about = 0 で正方形、1 で円
number-pinch = ピンチ
    .about = 両側を寄せる量
number-poisson = ポアソン比
    .about = 粘土が体積を保つ度合い: 0.5 で完全
number-offset = オフセット
    .about = 平面を法線方向に動かす量 (半径単位)
number-angle = 角度
    .about = 2 平面の法線の間、度
number-height = 高さ
    .about = 層が平面の上どこまで届くか (半径単位)
number-scale = スケール
    .about = 1 回の繰り返しの長さ (ブラシ幅単位)
number-floor = 基準
    .about = 面に残るアルファの高さ。それより低い部分はへこみます
number-width = 幅
    .about = アルファの幅 (ブラシ幅単位): 1 未満で繰り返し、1 を超えると切り取り
number-set = セット
    .about = 描く面セットの番号。0: ストロークごとに新しいセット

## The brush's settings

brush-heading = ブラシ
brush-more = その他のブラシ
brush-now = ブラシ: { $name }
brush-own = 自分のブラシ
    .tip = { $what } (もう一度: 保存時の状態)
brush-own-about = { $kind }: { $about }
brush-radius = 半径
    .tip = オブジェクトの大きさに対する割合 ({ $keys }、または { $drag } とドラッグ)
brush-strength = 強さ
    .tip = 1 回のダブの効果 ({ $keys }、または { $drag } とドラッグ)
brush-carve = 彫る
    .tip = { $action }。1 ストロークだけなら Ctrl を押したまま
brush-stroke = ストローク
brush-settings = その他の設定
brush-dab = ダブの形
brush-stamp = アルファとスタンプ
brush-automasks = 自動マスク
brush-topology = ダイナミックトポロジー

stroke-spacing = 間隔
    .tip = ダブの間隔 (半径に対する割合)
stroke-stabilizer = 安定化
    .tip = ブラシはこの距離でペンを追います (ビューの高さに対する割合)
stroke-steadiness = 手ぶれ補正
    .tip = ブラシがペンを追う糸の長さ (半径単位)
stroke-average = 平均する点数
    .tip = ブラシはペンのこの数の測定値の平均へ動きます
stroke-jitter = ジッター
    .tip = ダブを経路のまわりに散らす量 (半径単位)
stroke-seed = ジッターのシード:
stroke-method = 方式
stroke-continuous = ペンが止まっても続ける
stroke-ticks = 静止時の間隔 (ティック)
stroke-compensate = どの間隔でも同じ強さ
    .tip = 強さはペンの移動距離で数えます。オフでは毎回すべて効きます
stroke-accumulate = 蓄積
    .tip = ストロークは自分で盛った部分の上にも積みます
stroke-limit = ストロークの限度
    .tip = 1 ストロークで点が動ける量 (1 回のダブの高さ単位)。0: 制限なし

method-space = 等間隔
method-dots = 点
method-airbrush = エアブラシ
method-anchored = 固定
method-drag-dot = 点をドラッグ
method-line = 直線
method-curve = 点による曲線

dab-falloff = 減衰
dab-curve-tip = 半径の 8 分の { $eighths }
dab-hardness = 硬さ
    .tip = ブラシが完全に効く半径の割合
dab-smoothing = スムージング
    .tip = ダブごとにこの強さでならします
dab-averaging = 平均化
    .tip = 面の平面を平均する半径の割合
dab-plane-trim = 平面の限度
    .tip = 平面からこれより遠い部分は残ります (半径単位)。0: なし
dab-tilt = 傾き
    .tip = ペンと一緒にダブが傾く度合い
dab-colour = 色

falloff-gaussian = ガウス
falloff-smooth = スムーズ
falloff-sphere = 球状
falloff-root = ルート
falloff-sharp = シャープ
falloff-linear = リニア
falloff-constant = 一定
falloff-custom = カスタム

stamp-alpha = アルファ
stamp-stamp = スタンプ
stamp-size = スタンプの大きさ
stamp-angle = スタンプの角度
stamp-repeat = スタンプを繰り返す
stamp-right = ステンシル 右
stamp-up = ステンシル 上
stamp-at-tip = ビューの中心から、ビューの高さ単位
stamp-off = なし
stamp-dab = ダブごと
stamp-view = ビューに沿って
stamp-stencil = ステンシル

alpha-studs = 鋲
alpha-scales = うろこ
alpha-rope = ロープ
alpha-stitches = 縫い目
alpha-waves = 波
alpha-bricks = れんが
alpha-stone = 石
alpha-cracks = ひび
alpha-picture = 読み込んだ画像

automask-front = 前面のみ
automask-topology = つながった部分のみ
automask-sets = 最初に触れた面セットのみ
automask-boundary = 境界を固定
    .tip = 開いた面の境界は動きません
automask-normal = 法線の限度
    .tip = ダブの法線からこの角度以内の部分だけ。0: すべて
automask-cavity = くぼみ
    .tip = 0 より上はくぼみだけ、下は稜線だけ

topology-by = 辺の長さ
topology-length = 長さ
topology-split = 長い辺を分割
topology-collapse = 短い辺を縮約
topology-off = オフ
topology-brush = ブラシに対する割合
topology-object = オブジェクトに対する割合
topology-view = ビューに対する割合

## Mirror, pressure, masks, history

mirror-heading = 対称

pressure-heading = 筆圧
pressure-curve = 筆圧カーブ
    .tip = 左端をドラッグで最も軽い筆圧、中央で曲がり
pressure-lightest = 最小
pressure-bend = 曲がり
pressure-radius = 半径
    .tip = 最も軽い筆圧での半径の割合

mask-heading = マスク
mask-clear = 消去
    .tip = すべて自由になります
mask-fill = 全体
    .tip = すべて保護します
mask-invert = 反転
    .tip = 自由な部分を保護し、保護を解除します
mask-blur = ぼかし
    .tip = 境界を柔らかくします
mask-sharpen = シャープ
    .tip = 境界を鋭くします
mask-grow = 拡大
    .tip = 頂点 1 周分広げます
mask-shrink = 縮小
    .tip = 1 周分狭めます
mask-cavity = くぼみ
    .tip = くぼみを保護します
mask-thin = 薄い所
    .tip = この厚さ以下の所を保護します
mask-occlusion = 陰の所
    .tip = 物体自身が光を遮る所を保護します
mask-thin-below = 薄さ
    .tip = 最も長い辺に対する割合
mask-note = { $keys } で表示。マスクブラシで塗ります

history-heading = 履歴
history-steps = { $at } / { $all }
history-versions = { $count ->
   *[other] { $count } バージョン
}
history-step = ステップ
    .tip = ドラッグでステップをたどります
history-after = ステップ { $step } の後
history-version = バージョン
    .tip = ドラッグでこの系列のバージョンをたどります
history-row = バージョン { $node }、{ $time }
history-row-branch = バージョン { $node }、{ $time }、分岐
history-replaced = 置き換え
history-added = 追加
history-removed = 削除
history-duplicated = 複製
history-renamed = 名前の変更
history-moved = 移動
history-activated = アクティブ化
history-shown = 表示の切り替え
history-locked = ロックの切り替え
history-reshaped = 形状の変更
history-layers = レイヤー
history-sets = 面セット
history-mask = マスク
history-remesh = 三角形の大きさ
history-snapped = 面合わせ
history-boolean = ブーリアン
history-merged = 結合
history-split = 分離

## Page: look

look-material = マテリアル
material-clay = 粘土
material-porcelain = 磁器
material-wax = ろう
material-stone = 石
material-jade = 翡翠
material-bronze = ブロンズ
material-graphite = 黒鉛
look-facets = フラット
look-cavity = くぼみ
    .tip = くぼみを暗く、稜線を明るく
look-occlusion = オクルージョン
    .tip = { $action }: スクリーンスペースのアンビエントオクルージョン
look-wireframe = ワイヤーフレーム
look-grid = グリッド
look-smooth-edges = 滑らかな輪郭
    .tip = 1 ピクセルに 4 サンプル。グラフィックカードがないと時間がかかります
look-map = マップ
map-none = なし
    .tip = 粘土そのもの
map-mask = マスク
map-thickness = 厚み
map-distance = 距離
look-camera = カメラ
look-orthographic = 平行投影
look-angle = 画角
    .tip = 視野角、度
look-keep = 視点を保存
    .tip = この視点を番号で保存し、後で戻れます
    .show = この視点に戻ります。右クリックで削除
legend-measuring = 計測中

## Page: scene

scene-object = オブジェクト
scene-size = { $x } x { $y } x { $z } { $unit }
scene-held = 手に持つオブジェクト
    .tip = オブジェクトの横に現れ、中へ動かせます
scene-held-note = 形を取り、位置を合わせてから、合体、切り取り、共通部分を選びます。
scene-add = 合体
    .tip = 2 つを 1 つにします
scene-cut = 切り取り
    .tip = 持っているものでオブジェクトを切り取ります
scene-keep = 共通
    .tip = 両方に含まれる部分だけ残します
scene-put-down = 置く
    .tip = その場所でオブジェクトになります
scene-put-away = しまう
scene-busy = バックグラウンドで計算中。作業を続けられます
scene-preview = プレビュー
scene-computing = 計算中 ...
scene-shown = 持っているもの: 三角形 { $count } 枚
scene-apply = 適用
    .tip = 表示のとおりに実行します
scene-dismiss = 破棄
    .tip = オブジェクトも持っているものもそのままです
scene-yaw = ヨー
scene-pitch = ピッチ
scene-roll = ロール
scene-scale = スケール
scene-held-size = 大きさ

objects-heading = オブジェクト
objects-add = 追加
objects-duplicate = 複製
objects-rename = 名前を変更
objects-remove = 削除
objects-locked = ロック中: 造形、移動、削除はできません
objects-gizmo = ギズモ
    .tip = ポインターで移動・回転・拡大縮小します。Ctrl で刻み
objects-snap = 面と面を合わせる
    .tip = オブジェクトの平らな面を別のオブジェクトの面にぴったり合わせます
objects-snap-first = 動かす面を押す
objects-snap-second = 合わせる先の面を押す
objects-eye = 表示
    .tip = 描画する
objects-lock = ロック
    .tip = 造形、移動、削除から保護
objects-reset-place = 位置をリセット
    .tip = 作成した位置に戻します
shape-box = 箱
shape-ball = 球
shape-cylinder = 円柱
shape-cone = 円錐
shape-torus = トーラス
shape-tube = チューブ
shape-plane = 平面
operation-union = 合成
    .tip = アクティブなオブジェクトとこれを 1 つにします
operation-intersection = 交差
    .tip = 両方に含まれる部分だけ残します
operation-difference = 差分
    .tip = アクティブなものからこれを切り取ります
operation-reverse-difference = 逆の差分
    .tip = これからアクティブなものを切り取ります

sets-heading = 面セット
sets-eye-tip = 面セットの表示を切り替えます
sets-colours = 色で表示
sets-isolate = 単独
    .tip = この面セット以外を隠します
sets-draw = 描く
    .tip = この面セットを描くブラシを取ります
sets-none = セットなし: { $count }
sets-row = セット { $number }: { $count }
sets-hide-masked = マスク部を隠す
    .tip = 半分以上マスクされた部分を隠します
sets-invert = 表示を反転
    .tip = 表示部分を隠し、隠れた部分を表示します
sets-show-all = すべて表示
    .tip = 何も隠れていない状態にします
sets-clear = セットを消去
    .tip = どの頂点もセットに属さなくなります。隠れた部分は隠れたままです
sets-from-mask = マスクから
    .tip = 半分以上マスクされた部分を面セットにします
sets-from-visible = 表示部分から
    .tip = 表示されている部分を面セットにします
sets-loose = 離れた部分
    .tip = つながった部分ごとに面セットにします
sets-normals = 向きで分ける
    .tip = ほぼ同じ向きの部分ごとに面セットにします
sets-crease = 折り目で分ける
    .tip = この角度より強く曲がる所で面セットを分けます
sets-degrees = 角度
sets-thickness = 厚み
    .tip = 最も長い辺に対する割合。0 未満は内側
sets-extract-mask = マスクを抽出
    .tip = マスク部をこの厚みの閉じた殻として新しいオブジェクトにします
sets-extract-name = 抽出

layers-heading = レイヤー
layers-add = レイヤーを追加
    .tip = ストロークは新しいレイヤーに入ります
layers-name = レイヤー { $number }
layers-base = ベース
    .tip = ストロークはすべてのレイヤーの下に入ります
layers-unseen = アクティブなレイヤーが非表示か強さ 0 のため、ストロークは見えません
layers-topology = レイヤーがある間、ダイナミックトポロジーは働きません。使うには統合してください
layers-eye = 表示
    .tip = 表示中
layers-up = 上へ
    .tip = 次のレイヤーの上へ
layers-down = 下へ
    .tip = 次のレイヤーの下へ
layers-merge = 下に結合
    .tip = 下のレイヤーまたはベースに加えます。両方が表示されている必要があります
layers-duplicate = レイヤーを複製
    .tip = 上に非表示の複製を作ります
layers-clear = レイヤーを消去
    .tip = 効果を取り除きます
layers-remove = レイヤーを削除
    .tip = 効果とともに削除します
layers-rename = 名前を変更
layers-bake = レイヤーを統合
    .tip = 今の面がベースになります

levels-heading = レベル
levels-at = レベル { $at } / { $all }、三角形 { $count } 枚
levels-coarser = 粗く
    .tip = 全体の形を整えます。細かいレベルの細部も付いてきます
levels-finer = 細かく
    .tip = 三角形 1 枚を 4 枚に
    .back = 細かいレベルに戻ります

remesh-heading = リメッシュ
remesh-own = ボクセルを指定
    .tip = 指定しないと、新しい三角形は今とほぼ同じ大きさです
remesh-voxel = ボクセル
remesh-along = 最長辺に { $count } 個
remesh-sharp = 鋭い辺を保つ
remesh-button = リメッシュ
    .tip = そろった三角形の 1 つの面にします。重なった部分は 1 つになります。{ $keys }
remesh-local-heading = その場で
remesh-local-edge = 辺の長さ
    .tip = オブジェクトの通常の辺の長さに対する倍率
remesh-local-undo = { $keys } でいつでも、実行中でも元に戻せます。
remesh-stretched = 伸びた部分を細かく
    .tip = オブジェクト全体で長すぎる辺を分割します。マスクや非表示の部分は変わりません

quads-heading = 四角形
quads-count = 四角形の数
quads-levels = 細かいレベル
    .tip = 四角形が最も粗いレベルになり、細かいレベルが細部を戻します
quads-button = 四角形でリメッシュ
    .tip = 形に沿う四角形。レベルなしなら書き出しは四角形になります

decimate-heading = 間引き
decimate-share = 残す三角形
decimate-button = 間引く
    .tip = 印刷とウェブのために三角形を減らします。新しい自己交差は生じず、マスクの境界は残ります

trim-heading = トリム
trim-box = ボックス
    .tip = ビューの上でボックスをドラッグ。中の部分を奥まで切り落とします
trim-line = ライン
    .tip = ビューの上で線をドラッグ。左側を切り落とします
trim-note = ビューの上でドラッグ。Esc で中止。

region-heading = ビューの領域
region-draw = 領域:
region-lasso = 投げ縄
    .tip = 対象を囲むようにドラッグ
region-box = ボックス
    .tip = 角から角へドラッグ
region-line = ライン
    .tip = 線をドラッグ。左側が対象です
region-polyline = 折れ線
    .tip = 角を順にクリック
region-front = 前面のみ
    .tip = 手前を向く面のみ。オフなら奥まで
region-mask = マスク
    .tip = 領域の中を保護。Ctrl で解放
region-unmask = マスク解除
    .tip = 領域の中を解放。Ctrl で保護
region-hide = 隠す
    .tip = 領域の中を隠します。Ctrl でそれ以外
region-isolate = これだけ表示
    .tip = 領域以外を隠します。Ctrl で領域の中
region-face-set = 面セット
    .tip = 領域の中を新しい面セットにします
region-remesh = 三角形の大きさ
    .tip = 領域内の三角形がこの辺の長さになります。奥まで貫きます
region-done = 完了
    .tip = 領域の描画を終えます (Esc)
region-note = ビューの上でドラッグ。Ctrl で逆、Esc で終了。
region-polyline-note = 角をクリック。最初か最後の角をもう一度、または Enter で閉じます。

menu-add = 合体
menu-carve = 彫る
menu-keep = 共通部分
menu-put-away = しまう
menu-ball = 球
menu-box = 箱
menu-cylinder = 円柱
menu-undo = 元に戻す
menu-redo = やり直す
menu-pick-up = つかむ

## Page: walls

walls-heading = 壁の厚み
walls-live = ライブマップ
walls-process = 工法
walls-own-limit = 自分の限度
walls-too-thin-below = これ未満は薄い
walls-note = { $keys } を押すと、造形中もマップが粘土に追従します。
walls-thinnest = 最小
walls-median = 中央値
walls-thickest = 最大
walls-too-thin = 薄すぎ
walls-measured = 計測済み
walls-spots = 薄い箇所
walls-none = 限度を下回る箇所はありません。
walls-spot = { $number }: { $value } mm
    .tip = カメラがそこへ移動します
walls-histogram = 厚みのヒストグラム
    .tip = { $min } から { $max } mm。線は限度です
process-abs = 射出成形、ABS
process-fdm = 熱溶解積層 (FDM)
process-pa = 射出成形、ポリアミド (PA)
process-pc = 射出成形、ポリカーボネート (PC)
process-pom = 射出成形、ポリアセタール (POM)
process-pp = 射出成形、ポリプロピレン (PP)
process-sla = 光造形 (SLA)
process-sls = レーザー焼結 (SLS)

## Page: size

measure-heading = 計測
measure-waits = 変化がないときに計測します。
measure-volume = 体積
measure-area = 面積
measure-size = 寸法 { $axis }
measure-shadow = 影 { $axis }
measure-stale = 以前の状態の値です。変化がなくなると測り直します。
shadow-heading = 影
shadow-along = { $axis } 方向の影
    .tip = { $axis } 方向に見た影
shadow-here = ここから
    .tip = カメラの向きで見た影
shadow-size = { $x } x { $y } mm、穴 { $holes } 個
shadow-file = 書き出す図面
    .tip = 図面のファイル
shadow-write = SVG
    .tip = 輪郭を実寸の図面に、ミリメートル単位
shadow-outline = 影の輪郭
distance-heading = 距離
distance-live = 距離のライブマップ
distance-before = 以前と
    .tip = 開いたときのオブジェクトとの距離
distance-held = 持っているものと
distance-now = 今の状態と比べる
    .tip = 今のオブジェクトとの距離を測ります
distance-note = 青は内側、赤は外側です。
distance-deepest = 最深
distance-highest = 最高
distance-rms = rms
distance-known = 計測済み

## Page: files

files-open = 開く
    .note = メッシュをウィンドウにドロップ、または:
files-open-name = 開くファイル
files-browse = 参照...
files-recent = 最近使ったファイル
files-earlier = 以前の作品
files-export = エクスポート
files-export-name = 書き出すファイル
files-scale = スケール
files-unit = 単位
unit-mm = mm
unit-cm = cm
unit-m = m
unit-inch = inch
files-save-as = 名前を付けて保存...
files-pictures = 画像
files-screenshot = スクリーンショット
files-turntable = ターンテーブル
files-frames = フレーム
files-replace = 置き換える
    .question = { $path } は既にあります。置き換えますか?

chooser-open = メッシュを開く
chooser-export = 作品をエクスポート
chooser-meshes = メッシュ
chooser-home = ホーム
chooser-documents = ドキュメント
chooser-downloads = ダウンロード
chooser-desktop = デスクトップ
chooser-up = 上へ
chooser-reading = 読み込み中...
chooser-empty = フォルダーもメッシュファイルもありません
chooser-name = 名前

start-heading = 続きから
start-note = この新しい作品は作業中に自動で保存されます。
start-stay = このまま始める
start-session = { $object }、{ $date } { $time }

## Page: pens

devices-heading = デバイス
devices-none = タブレットがありません。つなぐだけで使えます。再起動は不要です。
    .mouse = マウスでも造形できます。ゆっくり動かすと強く押せます。
devices-in-range = 検知中
devices-pointer = ポインター
devices-tablet = タブレット { $number }
devices-serial = シリアルペン { $number }
devices-recording = 記録 { $number }
devices-demo = デモ用ペン { $number }
devices-pen = ペン { $number }
devices-eraser = { $pen }、消しゴム
devices-no-tilt = 傾きなし
devices-tilt = 傾き { $x }、{ $y } 度
devices-pressure = 筆圧 { $pressure }、{ $tilt }
devices-place = 位置 { $x } %、{ $y } %
devices-hands = { $count ->
   *[other] 手を { $count } つ検知
}
devices-strain = 腕の負担 { $percent } %
devices-rest = 腕の位置が高いです。休むか、低い位置で作業しましょう。
devices-nothing = なし
devices-curve = 左の筆圧カーブにペンの現在の筆圧が表示されます。
pose-neutral = 待機
pose-point = 指差し
pose-pinch = つまむ
pose-grab = 握る
pose-flat = 平手
pose-open = 開く

tablet-heading = タブレットのキー
tablet-choose = 押して選ぶ
    .tip = 続けてタブレットのキーかペンのボタンを押すか、リングを回します。その間ほかの動作はしません
tablet-listening = キーを押してください...
tablet-usual = 通常どおり ({ $action })
tablet-action = { $control } の動作
tablet-line = { $control }: { $action }
tablet-reset = リセット
    .tip = 通常の動作に戻す
tablet-none = すべて通常どおり動作します。
tablet-nothing = なし
tablet-next-mode = 次のモード
tablet-radius = 半径
    .back = 半径 (逆回り)
tablet-strength = 強さ
    .back = 強さ (逆回り)
tablet-turn = 押している間ビューを回す
tablet-slide = 押している間ビューを動かす
tablet-zoom = 押している間ズーム
tablet-radius-and-strength = ドラッグで半径と強さ
tablet-carve = 押している間彫る
tablet-brush = { $brush } ブラシ
    .held = 押している間 { $brush } ブラシ
control-key = キー { $number }
control-barrel = ペンのボタン { $number }
control-eraser = 消しゴム
control-wheel = ホイール { $number }
control-ring = リング { $number }
control-strip = ストリップ { $number }

## Page: loop

loop-heading = ループ
loop-tick = ティック
loop-late = 遅延
loop-samples = サンプル
loop-dabs = ダブ
loop-lost = 損失
    .note = 損失: 動き + 接触。後者は常に 0 です
loop-window = このウィンドウ
loop-frames = フレーム/秒
loop-frame = フレーム
loop-worst = 最悪
loop-to-clay = 粘土まで
loop-to-screen = 画面まで
    .note = 粘土まで、画面まで: 最新のサンプルから
loop-in-view = 表示中
loop-of = { $part } / { $all }
loop-uploaded = 転送
loop-object = オブジェクト
loop-vertices = 頂点
loop-triangles = 三角形
loop-saved = 作業中に保存: { $path }
loop-sample-to-screen = サンプルから画面まで
loop-up-to = { $value } ms まで
loop-longer = それ以上
loop-class = { $class }: { $count }
loop-histogram = { $frames } フレーム。{ $first } ms から、棒ごとに 2 倍
stage-tick = ティック
    .about = 読み取りから、それを使ったティックの終わりまで
stage-wait = 待ち
    .about = そのティックの終わりからフレームの始まりまで
stage-draw = 描画
    .about = フレームの始まりから画像の引き渡しまで
stage-present = 表示
    .about = 引き渡しから表示まで
stage-total = 合計
    .about = 読み取りから表示まで

## Page: more

preferences-heading = プリファレンス
preferences-language = 言語
preferences-language-system = システムの設定 ({ $name })
preferences-font = { $name } の文字を持つフォントがこのコンピューターにありません。Noto Sans CJK などを入れて、もう一度言語を選んでください。
preferences-text-size = 文字の大きさ
preferences-light = 明るいパネル
preferences-speed = 速さを筆圧にする
    .tip = マウス用: ゆっくりした動きほど強く押します
preferences-lead = ストロークをペンより先に表示
    .tip = 画面に見えるまでにペンが盛り上げる分を表示します。粘土そのものは実際のペンだけで決まります
preferences-fingers = 2 本指
    .tip = タッチ画面用。つまむとズーム、3 本指はもう一方の動作、3 本指タップで元に戻す、4 本指タップでやり直し
preferences-fingers-turn = 回す
preferences-fingers-slide = 動かす
preferences-lesson-skip = レッスンを飛ばす
preferences-lesson-again = 最初のレッスンをもう一度
preferences-keys = キー...
preferences-help = ヘルプ
preferences-search = アクションを検索
preferences-no-session = セッションファイルがありません。エクスポートしないと作品は残りません。

messages-heading = メッセージ
messages-loading = { $name } を読み込み中

## The window of the keys

keys-heading = キー
keys-set = セット
keys-as-in-set = セットのとおり
    .tip = 変更したキーをすべて取り消します
keys-find = 検索
keys-note = アクションのキーをクリックすると変更できます。
keys-shared = { $count ->
   *[other] { $count } 個のアクションが同じキーを使っています
}
keys-press = キーを押す...
keys-of = { $action } のキー
    .tip = クリックして新しいキーを押します。Esc で変更なし、Delete で解除
keys-also = 重複: { $actions } (選んだ方が優先)
    .own = 重複: { $actions } (こちらを実行)
keys-unknown-action = keys.own: "{ $id }" というアクションはありません
keys-unreadable = keys.own.{ $id }: "{ $keys }" はキーではありません。Z、F12、[、Ctrl+Shift+Z のように書きます

## Search, radial menu, dragged settings, curves

search-heading = アクションを検索
search-nothing = 見つかりません

radial-radius = 半径
radial-mirror = 対称 x
radial-thickness = 厚み
radial-frame = 全体表示
radial-strength = 強さ
radial-carve = 彫る

modal-radius = 半径 { $value }: クリックで確定、Esc で元のまま
modal-strength = 強さ { $value }: クリックで確定、Esc で元のまま

curve-note = 描くか点を置きます。ブラシが通る前に変更できます。
curve-points = { $count ->
   *[other] { $count } 点
}
curve-draw = 曲線を描く
    .tip = ブラシが 1 ステップで曲線をたどります (Enter)
curve-remove = 点を削除
    .tip = Delete、または点の上で右ボタン
curve-discard = 破棄
    .tip = 何も描きません (Esc)

## The first lesson

lesson-demo = デモを実行中です。いつでも粘土に触れてください
lesson-line = { $hint } ({ $at } / { $all })
lesson-sculpt = 粘土の上で押してドラッグ
lesson-turn = 粘土の外をドラッグで回転、スクロールでズーム
lesson-smooth = Shift を押したままなぞると滑らかになります
lesson-carve = Ctrl を押したままなぞると、盛らずに彫れます
lesson-undo = { $keys } で直前のストロークを取り消します
lesson-mirror = { $keys } または左の「対称」の x で、1 ストロークで両側に
    .no-keys = 左の「対称」で x を選んで描くと、両側に入ります

## Help

help-heading = ヘルプ
help-pages = 右側のページ
help-keys = キー
help-pen = ペンまたはマウス
help-pen-press = 粘土の上で押してドラッグ
    .does = 造形
help-pen-carve = Ctrl または Alt と一緒に
    .does = そのストロークだけ、盛らずに彫る
help-pen-smooth = Shift と一緒に
    .does = そのストロークだけ滑らかにする
help-pen-turn = 粘土の外、または右ボタンでドラッグ
    .does = ビューを回す
help-pen-slide = 中ボタン、または Shift と右ボタン
    .does = ビューを動かす
help-pen-zoom = ホイール
    .does = ポインターの下に近づく
help-pen-menu = Space を押したまま
    .does = ポインターのまわりのメニュー
help-fingers = 画面上の指
help-fingers-one = 粘土に 1 本指
    .does = 造形
help-fingers-two = 2 本指
    .does = ビューを回す。つまむとズーム
help-fingers-three = 3 本指
    .does = ビューを動かす (「その他」で入れ替え)
help-fingers-tap = 3 本指、4 本指でタップ
    .does = 元に戻す、やり直す
help-hands = センサーの上の素手
help-hands-index = 人差し指を伸ばす
    .does = 指先で粘土を押す
help-hands-pinch = 親指と人差し指を閉じる
    .does = 粘土をつかむ、運ぶ、放す
help-hands-flat = 指を伸ばしてそろえる
    .does = 手のひらで押し、ならす
help-hands-open = 指を伸ばして開く
    .does = ビューを回す。両手でズーム
help-hands-fist = 握りこぶし
    .does = ビューを動かす
help-hands-both = 両手でつまむ
    .does = 作品を持つ: 回す、動かす、拡大縮小
help-hands-menu = 左の球に指先を置く
    .does = 手のメニューから選ぶ
help-work = 作業は保存されます
help-work-close = いつでもウィンドウを閉じる
    .does = 続きから再開できます
help-work-files = 「ファイル」ページ
    .does = 開く、エクスポート、以前の作品

## Actions

action-brush = { $brush } ブラシ
action-page = ページ: { $page }
action-undo = 元に戻す
action-redo = やり直す
action-carve = 彫る・盛る
action-larger = ブラシを大きく
action-smaller = ブラシを小さく
action-stronger = ブラシを強く
action-weaker = ブラシを弱く
action-drag-radius = 半径をドラッグ
action-drag-strength = 強さをドラッグ
action-mirror-x = x で対称
action-mirror-y = y で対称
action-mirror-z = z で対称
action-frame = 作品全体を表示
action-front = 前から見る
action-back = 後ろから見る
action-left = 左から見る
action-right = 右から見る
action-top = 上から見る
action-bottom = 下から見る
action-perspective = 透視投影・平行投影
action-next-material = 次のマテリアル
action-facets = スムーズ・フラットシェーディング
action-ssao = アンビエントオクルージョン
action-wireframe = ワイヤーフレーム
action-grid = グリッド
action-thickness = 厚みマップ
action-mask = マスクマップ
action-distance = 距離マップ
action-trim-box = ボックスでトリム
action-trim-line = ラインでトリム
action-region-lasso = 投げ縄で領域
action-region-box = ボックスで領域
action-region-line = ラインで領域
action-region-polyline = 折れ線で領域
action-region-mask = 領域をマスク
action-region-unmask = 領域のマスクを解除
action-region-hide = 領域を隠す
action-region-isolate = 領域だけを表示
action-region-face-set = 領域から面セット
action-finer = 細かいレベル
action-coarser = 粗いレベル
action-remesh = リメッシュ
action-try-add = プレビュー: 持っているものを合体
action-try-cut = プレビュー: 持っているもので切り取り
action-try-keep = プレビュー: 共通部分
action-open-mesh = メッシュを開く
action-export = メッシュをエクスポート
action-screenshot = スクリーンショット
action-turntable = ターンテーブルのフレーム
action-search = アクションを検索
action-panels = パネル
action-light-or-dark = ライト・ダーク
action-larger-text = 文字を大きく
action-smaller-text = 文字を小さく
action-help = ヘルプ
action-keys = キーを変更
action-lesson = 最初のレッスン

## Messages of background tasks

task-loaded = { $name }: 頂点 { $count } 個
task-loop-ended = ループは終了しました
task-exported = 保存: { $path }: { $x } x { $y } x { $z } { $unit }
task-saved = 保存: { $path }
task-frames = { $frames } フレームを { $folder } に保存しました
task-failed = { $path }: { $error }
task-done = { $operation }: 完了
task-snapped = 面が合いました
task-trimmed = トリムしました
task-level = レベル { $at } / { $all }
task-remesh-local = 変更された辺: { $count }
task-remesh-taken-back = リメッシュは完了する前に元に戻されました。
task-remeshed = リメッシュ: 三角形 { $count } 枚、ボクセル { $voxel }、体積 { $change } %、交差: { $crossings }
task-quads = 四角形 { $quads } 枚、三角形 { $triangles } 枚、交差: { $crossings }
task-decimated = 三角形 { $before } 枚が { $now } 枚に、新しい交差: { $crossings }
task-layers-baked = 新しい面に統合したレイヤー: { $count }
task-sets-made = 面セットを作りました
task-mask-measured = マスク: { $count } 頂点
task-sets-dropped = 面セットは元の面とともに失われました。隠れた部分はありません
task-extracted = { $count } 頂点のオブジェクトを抽出しました
task-preferences-unreadable = { $path }: { $error }。{ $aside } として残しました
task-preferences-stuck = { $path }: { $error }。別名にできません: { $why }
task-preferences-unread = { $path }: プリファレンスを読めません: { $error }
task-preferences-not-kept = { $path }: プリファレンスを保存できません: { $error }
language-unreadable = { $path }: { $error }
